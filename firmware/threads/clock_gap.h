// Detects that the machine was suspended or that the process did not run.
#pragma once

#include "drivers/clock/clock.h"

namespace bevloc::firmware {

/// A gap: the machine was suspended, during which the steady clock stands still and the vehicle may
/// have been moved; or much time passed between two looks, because the process was stopped. One
/// thread.
class ClockGapDetector {
 public:
  /// Odometry bridges shorter gaps. Thirty bus cycles.
  static constexpr Duration kGap = std::chrono::milliseconds(300);

  /// To be called once per bus cycle. Returns whether there was a gap since the previous call.
  bool look(const drivers::Clock& clock) {
    const Time now = clock.now();
    const Duration suspended = clock.suspended();
    const bool gap = looked_ && (now - now_) + (suspended - suspended_) > kGap;
    looked_ = true;
    now_ = now;
    suspended_ = suspended;
    return gap;
  }

 private:
  bool looked_ = false;
  Time now_{};
  Duration suspended_{};
};

}  // namespace bevloc::firmware
