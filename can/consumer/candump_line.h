/* Reads one line of a candump log, for the examples: "(1.000000) can0 500#0011" or, of CAN FD,
   "(1.000000) can0 509##1001122". C99. */
#ifndef BEVLOC_CANDUMP_LINE_H
#define BEVLOC_CANDUMP_LINE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

struct candump_line {
  uint64_t time_us;
  uint32_t id;
  uint8_t data[64];
  uint8_t length;
};

/* False for a line that is not a data frame with an 11-bit identifier. */
static inline bool candump_parse(const char* text, struct candump_line* line) {
  unsigned long long seconds = 0;
  unsigned microseconds = 0;
  char frame[256];
  const char* digits;
  unsigned byte;
  if (sscanf(text, "(%llu.%6u%*[0-9)] %*s %255s", &seconds, &microseconds, frame) != 3)
    return false;
  if (strlen(frame) < 4 || frame[3] != '#' || sscanf(frame, "%3x", &line->id) != 1) return false;
  digits = frame + 4;
  if (digits[0] == '#') {
    if (digits[1] == '\0') return false;
    digits += 2; /* FD: the flags */
  }
  if (strlen(digits) % 2 != 0 || strlen(digits) > 128) return false;
  line->time_us = seconds * 1000000u + microseconds;
  line->length = 0;
  for (; *digits != '\0'; digits += 2) {
    if (sscanf(digits, "%2x", &byte) != 1) return false;
    line->data[line->length++] = (uint8_t)byte;
  }
  return true;
}

#endif
