// Reads the kernel's clocks and converts `timespec`.
#pragma once

#include <cassert>
#include <ctime>

#include "common/time.h"

namespace bevloc {

constexpr timespec timespec_of(Duration duration) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {.tv_sec = seconds.count(), .tv_nsec = (duration - seconds).count()};
}

constexpr Duration duration_of(const timespec& time) {
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

inline Duration read_clock(clockid_t clock) {
  timespec time{};
  [[maybe_unused]] const int failed = clock_gettime(clock, &time);
  assert(failed == 0);
  return duration_of(time);
}

/// The time of CLOCK_MONOTONIC. Only for code that compares with kernel timestamps or waits in the
/// kernel. All other code takes the time from a drivers::Clock.
inline Time steady_now() {
  return Time(read_clock(CLOCK_MONOTONIC));
}

}  // namespace bevloc
