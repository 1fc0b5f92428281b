#include "can/bus/receive_clock.h"

#include <algorithm>

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;

/// A frame does not wait longer than this in the socket.
constexpr nanoseconds kMaxAge = std::chrono::seconds(10);

/// The difference of the clocks is the smallest one of one to two periods. They are long enough for
/// a few frames, so that one of them had a fast interrupt. They are so short that the drift of the
/// clocks within them is small: at 500 ppm it is at most 0.15 ms.
constexpr nanoseconds kPeriod = std::chrono::milliseconds(150);
/// If the difference grows by more than this, the controller's clock has stood still or was set
/// back, because no interrupt is that late.
constexpr Duration kMaxLatency = std::chrono::milliseconds(20);

/// A larger change of the difference of the clocks from one frame to the next is a step: somebody
/// has set CLOCK_REALTIME. Time services change its rate by at most 500 ppm.
constexpr Duration kMinStep = std::chrono::milliseconds(1);
/// For this long after a step, a frame may still have a stamp from before the step.
constexpr Duration kStepLasts = kMaxAge;

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
  // A slow change (500 ppm) between two frames that are far apart is no step.
  const Duration passed = now.steady - watched_;
  watched_ = now.steady;
  if (std::chrono::abs(change) < kMinStep + passed / 2000) return;
  latest_step_ = change;
  stepped_ = now.steady;
  offset_.reset();
}

/// The kernel's stamp is late by the interrupt's latency, and never early. So the smallest
/// difference of the two clocks is the most accurate one. Old differences are forgotten, because
/// the clocks drift: a time service may steer ours, and the controller's oscillator may be cheap.
Time ReceiveClock::from_hardware(nanoseconds hardware, Time by_kernel) {
  const Duration difference = by_kernel.time_since_epoch() - hardware;
  const int64_t period = hardware / kPeriod;
  const bool known =
      offset_ && period >= offset_->period && difference - offset_->smallest() <= kMaxLatency;
  if (!known) {
    offset_ = {period, difference, difference};
  } else if (period == offset_->period) {
    offset_->in_period = std::min(offset_->in_period, difference);
  } else {
    const bool is_next = period == offset_->period + 1;
    offset_ = {period, difference, is_next ? offset_->in_period : difference};
  }
  return Time(hardware + offset_->smallest());
}

}  // namespace bevloc::can
