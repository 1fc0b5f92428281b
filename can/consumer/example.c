/* Prints each change of the answer, and a pose a second, from a candump log or a CAN interface:
     consumer_c can.log
     consumer_c --interface vcan0
   The alert limits are those of a freeway (docs/can.md). */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <inttypes.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "bevloc.h"
#include "candump_line.h"

static const struct bevloc_alert_limits kFreeway = {0.57, 1.40, 1.50, 5};

/* The same in all three examples, so that their outputs can be compared. */
struct printer {
  struct bevloc_receiver receiver;
  bool has_first;
  uint64_t first_us;
  uint64_t next_us;
  int answer;
};

static void print_line(struct printer* printer, uint64_t now_us, enum bevloc_answer answer) {
  const struct bevloc_pose* pose = &printer->receiver.pose;
  /* It is negative if the clock was set back. */
  const int64_t since_first_us = (int64_t)(now_us - printer->first_us);
  printf("%.3f %s", (double)since_first_us * 1e-6, bevloc_answer_name(answer));
  if (answer == BEVLOC_USABLE) {
    printf(" east %.2f north %.2f heading %.2f lateral %.2f longitudinal %.2f yaw %.2f",
           pose->east_m, pose->north_m, pose->heading_deg, pose->lateral_m, pose->longitudinal_m,
           pose->yaw_deg);
  }
  printf("\n");
}

static void look(struct printer* printer, uint64_t now_us) {
  const enum bevloc_answer answer = bevloc_answer(&printer->receiver, now_us);
  if (!printer->has_first) printer->first_us = now_us;
  printer->has_first = true;
  if ((int)answer == printer->answer && (answer != BEVLOC_USABLE || now_us < printer->next_us))
    return;
  print_line(printer, now_us, answer);
  printer->answer = (int)answer;
  printer->next_us = now_us + 1000000;
}

/* A frame that arrived at `arrival_us` is read at `now_us`. */
static void take(struct printer* printer, uint32_t id, const uint8_t* data, size_t length,
                 uint64_t arrival_us, uint64_t now_us) {
  if (printer->answer >= 0) look(printer, now_us);
  bevloc_receive(&printer->receiver, id, data, length, arrival_us);
  look(printer, now_us);
}

static void print_counters(const struct bevloc_counters* counters) {
  printf("frames: %" PRIu32 " ok, %" PRIu32 " lost, %" PRIu32 " repeated, %" PRIu32
         " wrong CRC, %" PRIu32 " wrong length; %" PRIu32 " incomplete poses\n",
         counters->ok, counters->lost, counters->repeated, counters->wrong_crc,
         counters->wrong_length, counters->incomplete);
}

static int refuse_file(const char* path) {
  fprintf(stderr, "%s: found no readable file, wanted a candump log\n", path);
  return 1;
}

static int read_log(struct printer* printer, const char* path) {
  char text[512];
  bool readable = false;
  int number = 0;
  struct candump_line frame = {0};
  struct candump_interface first = {0};
  enum candump_kind kind = CANDUMP_OTHER;
  FILE* log = fopen(path, "r");
  if (log == NULL) return refuse_file(path);
  while (kind != CANDUMP_BAD && fgets(text, sizeof text, log) != NULL) {
    ++number;
    kind = candump_parse(text, &frame);
    if (kind != CANDUMP_DATA || !candump_is_of_first(&first, &frame, path, number)) continue;
    take(printer, frame.id, frame.data, frame.length, frame.time_us, frame.time_us);
  }
  readable = ferror(log) == 0; /* a folder opens, but cannot be read */
  fclose(log);
  if (!readable) return refuse_file(path);
  if (kind == CANDUMP_BAD) {
    fflush(stdout);
    fprintf(stderr, "%s:%d: found something else, wanted %s\n", path, number, CANDUMP_WANTED);
    return 1;
  }
  print_counters(&printer->receiver.counters);
  return 0;
}

/* Returns a socket that waits at most 10 ms for a frame and stamps each frame, or -1. */
static int open_interface(const char* interface) {
  struct sockaddr_can address = {0};
  const struct timeval patience = {0, 10000};
  const int on = 1;
  const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (bus < 0) return -1;
  address.can_family = AF_CAN;
  address.can_ifindex = (int)if_nametoindex(interface);
  if (address.can_ifindex == 0 ||
      setsockopt(bus, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) != 0 ||
      setsockopt(bus, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0 ||
      setsockopt(bus, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0 ||
      bind(bus, (struct sockaddr*)&address, sizeof address) != 0) {
    return -1;
  }
  return bus;
}

static uint64_t microseconds(const struct timespec* time) {
  return (uint64_t)time->tv_sec * 1000000u + (uint64_t)time->tv_nsec / 1000u;
}

static uint64_t time_of(clockid_t clock) {
  struct timespec time;
  clock_gettime(clock, &time);
  return microseconds(&time);
}

/* Reads a frame, and says how long ago it arrived. A program that was held up reads old frames. The
   kernel stamps them by CLOCK_REALTIME, which may be set; so use only the age. */
static bool receive(int bus, struct canfd_frame* frame, uint64_t* age_us) {
  union {
    struct cmsghdr header; /* for its alignment */
    char bytes[CMSG_SPACE(sizeof(struct timespec))];
  } control;
  struct iovec content = {frame, sizeof *frame};
  struct msghdr message = {0};
  struct cmsghdr* part;
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = &control;
  message.msg_controllen = sizeof control;
  *age_us = 0;
  if (recvmsg(bus, &message, 0) <= 0) return false;
  for (part = CMSG_FIRSTHDR(&message); part != NULL; part = CMSG_NXTHDR(&message, part)) {
    struct timespec stamp;
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_TIMESTAMPNS) continue;
    memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
    *age_us = time_of(CLOCK_REALTIME) - microseconds(&stamp);
    if ((int64_t)*age_us < 0) *age_us = 0; /* the clock was set back */
  }
  return true;
}

/* Checks the answer also while no frame arrives, so that a silence is noticed. */
static int read_interface(struct printer* printer, const char* interface) {
  struct canfd_frame frame;
  const int bus = open_interface(interface);
  while (bus >= 0) {
    uint64_t age_us, now_us;
    const bool received = receive(bus, &frame, &age_us);
    if (!received && errno != EAGAIN && errno != EINTR) break;
    now_us = time_of(CLOCK_MONOTONIC);
    if (received && (frame.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_ERR_FLAG)) == 0) {
      take(printer, frame.can_id, frame.data, frame.len, now_us - age_us, now_us);
    } else {
      look(printer, now_us);
    }
  }
  fprintf(stderr, "%s: found no frames (%s), wanted a CAN interface that is up\n", interface,
          strerror(errno));
  if (bus >= 0) print_counters(&printer->receiver.counters);
  return 2;
}

int main(int argc, char** argv) {
  struct printer printer = {.answer = -1};
  setvbuf(stdout, NULL, _IOLBF, 0);
  bevloc_init(&printer.receiver, BEVLOC_LOCALIZER_BASE, kFreeway);
  if (argc == 3 && strcmp(argv[1], "--interface") == 0) return read_interface(&printer, argv[2]);
  if (argc == 2) return read_log(&printer, argv[1]);
  fprintf(stderr, "usage: consumer_c FILE | consumer_c --interface NAME\n");
  return 2;
}
