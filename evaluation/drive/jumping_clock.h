// A clock that can jump ahead of the machine's, as if the appliance had stood still.
#pragma once

#include <atomic>

#include "drivers/clock/clock.h"

namespace bevloc::evaluation {

/// Thread-safe.
class JumpingClock final : public drivers::Clock {
 public:
  Time now() const override { return machine_.now() + ahead(); }
  void sleep_until(Time time) override { machine_.sleep_until(time - ahead()); }

  void jump(Duration duration) { ahead_ns_ += duration.count(); }

 private:
  Duration ahead() const { return Duration(ahead_ns_.load()); }

  drivers::MonotonicClock machine_;
  std::atomic<int64_t> ahead_ns_{0};
};

}  // namespace bevloc::evaluation
