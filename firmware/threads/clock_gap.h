// Detects that the machine was suspended or that the process did not run.
#pragma once

#include "common/time.h"

namespace bevloc::firmware {

/// Detects two kinds of gap. Either the machine was suspended, while the steady clock stood still
/// and the vehicle may have been moved. Or much time passed between two looks, because the process
/// was stopped. One thread.
class ClockGapDetector {
 public:
  /// The shortest gap, which is thirty bus cycles. Odometry bridges shorter ones.
  static constexpr Duration kGap = std::chrono::milliseconds(300);

  /// Call it once per bus cycle, with Clock::suspended(). Returns whether there was a gap since the
  /// previous call.
  bool look(Time now, Duration suspended) {
    const bool gap = looked_ && (now - now_) + (suspended - suspended_) > kGap;
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
