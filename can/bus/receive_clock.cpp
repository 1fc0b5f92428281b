#include "can/bus/receive_clock.h"

#include <algorithm>

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;

/// A frame does not wait longer than this in the socket.
constexpr nanoseconds kMaxAge = std::chrono::seconds(10);

/// A larger jump between the clocks shows that the controller has restarted, because no interrupt
/// is that late.
constexpr Duration kMaxJump = std::chrono::seconds(1);

/// A larger change of the difference of the clocks from one frame to the next is a step: somebody
/// has set CLOCK_REALTIME. Time services change its rate by at most 500 ppm.
constexpr Duration kMinStep = std::chrono::milliseconds(1);
/// For this long after a step, a frame may still have a stamp from before the step.
constexpr Duration kStepLasts = kMaxAge;

/// The largest drift between the controller's clock and ours: 100 ppm.
Duration drift_in(nanoseconds time) {
  return time / 10'000;
}

}  // namespace

ReceiveClock::Stamped ReceiveClock::to_steady(const KernelStamps& stamps, const Now& now) {
  Stamped stamped{now.steady, StampSource::kArrival};
  watch_realtime(now);
  if (stamps.software) {
    const auto age = age_of(*stamps.software, now);
    if (age) stamped = {now.steady - *age, StampSource::kSoftware};
  }
  if (stamps.hardware) {
    stamped = {from_hardware(*stamps.hardware, stamped.time), StampSource::kHardware};
  }
  stamped.time = std::min(std::max(stamped.time, last_), now.steady);
  last_ = stamped.time;
  return stamped;
}

/// After a step, a stamp has two possible ages, because it may be from before or from after the
/// step. They differ by the step. The smaller one that is not negative is right, unless the frame
/// waited longer than the step.
std::optional<Duration> ReceiveClock::age_of(nanoseconds software, const Now& now) const {
  const auto is_possible = [](Duration age) { return age >= Duration::zero() && age <= kMaxAge; };
  const Duration age = now.realtime - software;
  if (stepped_ && is_possible(age - latest_step_) &&
      (age - latest_step_ < age || !is_possible(age))) {
    return age - latest_step_;
  }
  return is_possible(age) ? std::optional(age) : std::nullopt;
}

void ReceiveClock::watch_realtime(const Now& now) {
  const Duration difference = now.realtime - now.steady.time_since_epoch();
  const Duration change =
      realtime_minus_steady_ ? difference - *realtime_minus_steady_ : Duration{};
  realtime_minus_steady_ = difference;
  if (stepped_ && now.steady - *stepped_ > kStepLasts) stepped_.reset();
  // A slow change between two frames that are far apart is no step.
  const Duration passed = now.steady - watched_;
  watched_ = now.steady;
  if (std::chrono::abs(change) < kMinStep + 5 * drift_in(passed)) return;
  latest_step_ = change;
  stepped_ = now.steady;
  steady_minus_hardware_.reset();
}

/// The kernel's stamp is late by the interrupt's latency, and never early. So the smallest
/// difference of the two clocks is the most accurate one. It may grow at the rate of the largest
/// drift.
Time ReceiveClock::from_hardware(nanoseconds hardware, Time by_kernel) {
  const Duration difference = by_kernel.time_since_epoch() - hardware;
  const bool known = steady_minus_hardware_ && hardware >= last_hardware_ &&
                     std::chrono::abs(difference - *steady_minus_hardware_) < kMaxJump;
  if (known) {
    const Duration grown = *steady_minus_hardware_ + drift_in(hardware - last_hardware_);
    steady_minus_hardware_ = std::min(difference, grown);
  } else {
    steady_minus_hardware_ = difference;
  }
  last_hardware_ = hardware;
  return Time(hardware + *steady_minus_hardware_);
}

}  // namespace bevloc::can
