/* Reads one line of a candump log, for the examples: "(1.000000) can0 500#0011" or, of CAN FD,
   "(1.000000) can0 509##1001122". C99. */
#ifndef BEVLOC_CANDUMP_LINE_H
#define BEVLOC_CANDUMP_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CANDUMP_WANTED "a line of candump -l, such as '(1436509052.249713) can0 044#2A366C2BBA'"

enum candump_kind {
  CANDUMP_DATA,  /* a data frame with an 11-bit identifier */
  CANDUMP_OTHER, /* an empty line, a count of dropped frames (candump -d), a remote frame, or a
                    29-bit identifier as error frames have */
  CANDUMP_BAD    /* anything else */
};

/* C has no nullptr. NOLINTBEGIN(modernize-use-nullptr) */

enum { CANDUMP_NAME_SIZE = 16 }; /* as in Linux, with the zero byte */

struct candump_line {
  uint64_t time_us;
  char interface[CANDUMP_NAME_SIZE]; /* a longer name is cut off */
  uint32_t id;
  uint8_t data[64];
  uint8_t length;
};

static inline size_t candump_digits(const char* text, bool hexadecimal) {
  return strspn(text, hexadecimal ? "0123456789ABCDEFabcdef" : "0123456789");
}

/* Reads "(1.000000) can0 ", with 6 or 9 digits after the point. Blanks may precede the interface,
   because candump aligns the names. Returns the rest of the line, or NULL if the line does not
   begin so. */
static inline const char* candump_parse_beginning(const char* text, struct candump_line* line) {
  size_t whole, parts;
  if (*text++ != '(') return NULL;
  whole = candump_digits(text, false);
  if (whole == 0 || whole > 13 || text[whole] != '.') return NULL;
  parts = candump_digits(text + whole + 1, false);
  if ((parts != 6 && parts != 9) || strncmp(text + whole + 1 + parts, ") ", 2) != 0) return NULL;
  line->time_us = (uint64_t)strtoull(text, NULL, 10) * 1000000u;
  text += whole + 1;
  line->time_us += (uint64_t)strtoull(text, NULL, 10) / (parts == 9 ? 1000u : 1u);
  text += parts + 2;
  text += strspn(text, " ");
  whole = strcspn(text, " ");
  if (whole == 0 || text[whole] == '\0') return NULL;
  parts = whole < sizeof line->interface ? whole : sizeof line->interface - 1;
  memcpy(line->interface, text, parts);
  line->interface[parts] = '\0';
  return text + whole + 1;
}

/* Reads the bytes up to the end of the frame, which a raw length code such as "_F" may precede. */
static inline bool candump_parse_data(const char* digits, bool fd, struct candump_line* line) {
  const size_t count = candump_digits(digits, true);
  const char* end = digits + count;
  size_t i;
  if (!fd && *end == '_' && candump_digits(end + 1, true) > 0) end += 2;
  if (*end != '\0' && strchr(" \r\n", *end) == NULL) return false;
  if (count % 2 != 0 || count > (fd ? 128u : 16u)) return false;
  line->length = (uint8_t)(count / 2);
  for (i = 0; i < line->length; ++i) {
    const char byte[3] = {digits[2 * i], digits[2 * i + 1], '\0'};
    line->data[i] = (uint8_t)strtoul(byte, NULL, 16);
  }
  return true;
}

/* `text` includes the line end. It is empty only if the line begins with a zero byte. */
static inline enum candump_kind candump_parse(const char* text, struct candump_line* line) {
  size_t count;
  bool fd;
  if (*text != '\0' && text[strspn(text, "\r\n")] == '\0') return CANDUMP_OTHER;
  if (strncmp(text, "DROPCOUNT: ", 11) == 0) return CANDUMP_OTHER;
  text = candump_parse_beginning(text, line);
  if (text == NULL) return CANDUMP_BAD;
  count = candump_digits(text, true);
  if ((count != 3 && count != 8) || text[count] != '#') return CANDUMP_BAD;
  line->id = (uint32_t)strtoul(text, NULL, 16);
  text += count + 1;
  if (count == 8 || *text == 'R') return CANDUMP_OTHER;
  fd = *text == '#';
  if (fd && candump_digits(++text, true) == 0) return CANDUMP_BAD;
  if (fd) ++text; /* the flags */
  return line->id <= 0x7FF && candump_parse_data(text, fd, line) ? CANDUMP_DATA : CANDUMP_BAD;
}

/* The interface whose frames are read: that of the first frame. Zero it before the first line. */
struct candump_interface {
  char name[CANDUMP_NAME_SIZE];
  bool has_others;
};

/* Whether the frame is of the first interface. Each interface is a bus of its own, so do not mix
   their frames. Says once on standard error that there are others. */
static inline bool candump_is_of_first(struct candump_interface* first,
                                       const struct candump_line* line, const char* path,
                                       int number) {
  if (first->name[0] == '\0') memcpy(first->name, line->interface, sizeof first->name);
  if (strcmp(first->name, line->interface) == 0) return true;
  if (!first->has_others) {
    fprintf(stderr, "%s:%d: found interface %s after %s, wanted one; all but %s are skipped\n",
            path, number, line->interface, first->name, first->name);
  }
  first->has_others = true;
  return false;
}

/* NOLINTEND(modernize-use-nullptr) */

#endif
