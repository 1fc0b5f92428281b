// Asks the kernel whether a time service (chrony, linuxptp) disciplines the system clock.
#pragma once

#include "common/time.h"

struct timex;

namespace bevloc::drivers {

/// What adjtimex(2) says about CLOCK_REALTIME.
struct ClockDiscipline {
  bool synchronized = false;   ///< STA_UNSYNC is clear, and the kernel reports no error
  Duration max_error{};        ///< the kernel's bound of the clock's error; grows by 500 ppm
  Duration estimated_error{};  ///< as the time service estimates it
};

/// The kernel's answer in other words; `answer` is the result of adjtimex().
ClockDiscipline discipline_of(int answer, const timex& state);

/// CLOCK_REALTIME, and how good it is.
struct WallTime {
  Duration since_1970{};  ///< UTC
  ClockDiscipline discipline;
};

/// Not synchronized where the kernel refuses the question (SystemCallFilter= of systemd).
/// Thread-safe, does not block.
ClockDiscipline read_clock_discipline();
WallTime read_wall_time();

}  // namespace bevloc::drivers
