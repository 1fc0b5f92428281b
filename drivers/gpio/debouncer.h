// Makes one change of a switch's many.
#pragma once

#include "common/time.h"

namespace bevloc::drivers {

/// A level counts once it has held for some time. Pure logic; levels come in the order of time.
class Debouncer {
 public:
  Debouncer(bool level, Duration hold) : settled_(level), latest_(level), hold_(hold) {}

  /// What the line became, or still is, at `time`.
  void see(bool level, Time time) {
    if (level == latest_) return;
    settled_ = settled_at(time);
    latest_ = level;
    since_ = time;
  }

  bool settled_at(Time now) const {
    return latest_ != settled_ && now - since_ >= hold_ ? latest_ : settled_;
  }

 private:
  bool settled_;
  bool latest_;
  Time since_{};
  Duration hold_;
};

}  // namespace bevloc::drivers
