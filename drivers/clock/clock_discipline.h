// Asks the kernel whether a time service (chrony, linuxptp) disciplines the system clock.
#pragma once

#include "common/time.h"

struct timex;

namespace bevloc::drivers {

/// What adjtimex(2) says about CLOCK_REALTIME.
struct ClockDiscipline {
  bool synchronized = false;   ///< STA_UNSYNC is clear, and the kernel reports no error
  Duration max_error{};        ///< the kernel's bound of the clock's error, which grows by 500 ppm
  Duration estimated_error{};  ///< the error as the time service estimates it
};

/// Converts the answer of the kernel. `answer` is the result of adjtimex().
ClockDiscipline discipline_of(int answer, const timex& state);

/// The time of CLOCK_REALTIME, and how good it is.
struct WallTime {
  Duration since_1970{};  ///< UTC
  ClockDiscipline discipline;
};

/// Asks the kernel. The clock counts as not synchronized if the kernel refuses to answer
/// (SystemCallFilter= of systemd). Thread-safe. Does not block.
ClockDiscipline read_clock_discipline();
WallTime read_wall_time();

}  // namespace bevloc::drivers
