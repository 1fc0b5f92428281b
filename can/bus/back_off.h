// Decides when a failed action is tried again.
#pragma once

#include <algorithm>

#include "common/time.h"

namespace bevloc::can {

/// Exponential back-off: each failure doubles the delay before the next attempt, up to a limit. One
/// thread.
class BackOff {
 public:
  BackOff(Duration first, Duration longest) : first_(first), longest_(longest), delay_(first) {}

  bool is_due(Time now) const { return now >= next_; }

  void note_failure(Time now) {
    next_ = now + delay_;
    delay_ = std::min(2 * delay_, longest_);
  }

  void reset() {
    next_ = Time::min();
    delay_ = first_;
  }

 private:
  Duration first_;
  Duration longest_;
  Duration delay_;
  Time next_ = Time::min();
};

}  // namespace bevloc::can
