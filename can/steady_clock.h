// The kernel's clocks, for what the kernel stamps.
#pragma once

#include <ctime>

#include "common/time.h"

namespace bevloc::can {

inline std::chrono::nanoseconds read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

inline Time steady_now() {
  return Time(read_clock(CLOCK_MONOTONIC));
}

}  // namespace bevloc::can
