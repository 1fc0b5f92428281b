#include "drivers/clock/clock.h"

#include <cassert>
#include <cerrno>
#include <ctime>

#include "common/kernel_time.h"

namespace bevloc::drivers {

Time MonotonicClock::now() const {
  return steady_now();
}

void MonotonicClock::sleep_until(Time time) {
  if (time <= Time{}) return;
  const timespec spec = timespec_of(time.time_since_epoch());
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &spec, nullptr) == EINTR) {
  }
}

/// CLOCK_BOOTTIME goes on while the machine is suspended.
Duration MonotonicClock::suspended() const {
  const ClockPair clocks = read_with_steady(CLOCK_BOOTTIME);
  return clocks.clock - clocks.steady.time_since_epoch();
}

Duration MonotonicClock::unsteered() const {
  return read_clock(CLOCK_MONOTONIC_RAW);
}

void VirtualClock::advance(Duration duration) {
  assert(duration >= Duration::zero());
  now_ += duration;
}

}  // namespace bevloc::drivers
