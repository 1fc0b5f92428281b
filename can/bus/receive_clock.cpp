#include "can/bus/receive_clock.h"

#include <algorithm>

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;

/// A frame does not wait longer than this in the socket. A larger age shows that somebody has set
/// CLOCK_REALTIME.
constexpr nanoseconds kMaxAge = std::chrono::seconds(10);

/// A larger jump between the clocks shows that the controller has restarted; a late interrupt is
/// shorter.
constexpr Duration kMaxJump = std::chrono::seconds(1);

/// The largest drift between the controller's clock and ours: 100 ppm.
Duration drift_in(nanoseconds time) {
  return time / 10'000;
}

}  // namespace

ReceiveClock::Stamped ReceiveClock::to_steady(const KernelStamps& stamps, const Now& now) {
  Stamped stamped{now.steady, StampSource::kArrival};
  if (stamps.software) {
    const nanoseconds age = now.realtime - *stamps.software;
    if (age >= nanoseconds::zero() && age <= kMaxAge) {
      stamped = {now.steady - age, StampSource::kSoftware};
    }
  }
  if (stamps.hardware) {
    stamped = {from_hardware(*stamps.hardware, stamped.time), StampSource::kHardware};
  }
  stamped.time = std::min(std::max(stamped.time, last_), now.steady);
  last_ = stamped.time;
  return stamped;
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
