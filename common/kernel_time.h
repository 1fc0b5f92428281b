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

/// The time of CLOCK_MONOTONIC. Only code that compares times with time stamps of the kernel, or
/// that waits in the kernel, calls it. All other code takes the time from a drivers::Clock.
inline Time steady_now() {
  return Time(read_clock(CLOCK_MONOTONIC));
}

/// A clock and CLOCK_MONOTONIC at one moment.
struct ClockPair {
  Duration clock{};
  Time steady{};
  Duration error{};  ///< the two readings are at most this far apart
};

/// Reads `clock` between two readings of CLOCK_MONOTONIC. If these are far apart, because another
/// thread ran in between, it reads again, at most kTries times in all, and keeps the closest ones.
inline ClockPair read_with_steady(clockid_t clock) {
  constexpr Duration kClose = std::chrono::microseconds(5);
  constexpr int kTries = 10;
  ClockPair closest{.error = Duration::max()};
  for (int i = 0; i < kTries && closest.error > kClose; ++i) {
    const Time before = steady_now();
    const Duration reading = read_clock(clock);
    const Duration half = (steady_now() - before) / 2;
    if (half < closest.error) closest = {reading, before + half, half};
  }
  return closest;
}

}  // namespace bevloc
