// Debounces a switch input.
#pragma once

#include "common/time.h"

namespace bevloc::drivers {

/// A new level counts after it has lasted for the hold time. Levels must come in the order of time.
/// One thread.
class Debouncer {
 public:
  Debouncer(bool level, Duration hold) : settled_(level), latest_(level), hold_(hold) {}

  /// Takes the level of the line at `time`, changed or not.
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
