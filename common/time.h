// The time and duration types of the project.
#pragma once

#include <chrono>

namespace bevloc {

/// Steady time in nanoseconds. It has no now(): code that needs the time is given a drivers::Clock,
/// so that a test or a `--fast` drive can supply virtual time.
struct SteadyTimescale {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<SteadyTimescale>;
  static constexpr bool is_steady = true;
};

using Time = SteadyTimescale::time_point;
using Duration = SteadyTimescale::duration;

constexpr double to_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

constexpr double to_milliseconds(Duration duration) {
  return 1e3 * to_seconds(duration);
}

/// Rounds towards zero to whole nanoseconds.
constexpr Duration from_seconds(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// Rounds towards zero to whole nanoseconds.
constexpr Duration from_milliseconds(double milliseconds) {
  return from_seconds(1e-3 * milliseconds);
}

}  // namespace bevloc
