// Detects that the machine was suspended or that the process did not run.
#pragma once

#include "common/time.h"

namespace bevloc::firmware {

/// Detects two kinds of gap. Either the machine was suspended, or much time passed between two
/// looks, because the process was stopped. One thread.
class ClockGapDetector {
 public:
  /// A longer time between two looks is a gap. It is thirty bus cycles. Odometry bridges shorter
  /// times.
  static constexpr Duration kGap = std::chrono::milliseconds(300);
  /// A longer suspension is a gap. The limit is smaller than kGap, because the steady clock stands
  /// still meanwhile. The time stamps of odometry therefore do not show that the vehicle drove on.
  /// Clock::suspended() is read to some microseconds, also if another thread runs in between.
  static constexpr Duration kSuspension = std::chrono::milliseconds(20);

  /// Call it once per bus cycle, with Clock::suspended(). Returns whether there was a gap since the
  /// previous call.
  bool look(Time now, Duration suspended) {
    const bool gap = looked_ && (now - now_ > kGap || suspended - suspended_ > kSuspension);
    looked_ = true;
    now_ = now;
    suspended_ = suspended;
    return gap;
  }

  /// Clock::suspended() at the latest look.
  Duration suspended() const { return suspended_; }

 private:
  bool looked_ = false;
  Time now_{};
  Duration suspended_{};
};

}  // namespace bevloc::firmware
