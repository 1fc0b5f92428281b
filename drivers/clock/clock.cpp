#include "drivers/clock/clock.h"

#include <cassert>
#include <cerrno>
#include <ctime>

namespace bevloc::drivers {
namespace {

constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;

}  // namespace

Time MonotonicClock::now() const {
  timespec spec{};
  [[maybe_unused]] const int failed = clock_gettime(CLOCK_MONOTONIC, &spec);
  assert(failed == 0);
  return Time(Duration(spec.tv_sec * kNanosecondsPerSecond + spec.tv_nsec));
}

void MonotonicClock::sleep_until(Time time) {
  const int64_t nanoseconds = time.time_since_epoch().count();
  if (nanoseconds <= 0) return;
  const timespec spec{nanoseconds / kNanosecondsPerSecond, nanoseconds % kNanosecondsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &spec, nullptr) == EINTR) {
  }
}

void VirtualClock::advance(Duration duration) {
  assert(duration >= Duration::zero());
  now_ += duration;
}

}  // namespace bevloc::drivers
