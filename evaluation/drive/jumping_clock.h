// A clock that can jump ahead of the machine's, as if the appliance had stood still, and that can
// claim that the machine was suspended.
#pragma once

#include <atomic>

#include "drivers/clock/clock.h"

namespace bevloc::evaluation {

/// Thread-safe.
class JumpingClock final : public drivers::Clock {
 public:
  Time now() const override { return machine_.now() + ahead(); }
  void sleep_until(Time time) override { machine_.sleep_until(time - ahead()); }

  Duration suspended() const override {
    return machine_.suspended() + Duration(suspended_ns_.load());
  }

  Duration unsteered() const override { return machine_.unsteered() + ahead(); }

  void advance(Duration duration) { ahead_ns_ += duration.count(); }
  /// Simulates that the machine was suspended.
  void suspend(Duration duration) { suspended_ns_ += duration.count(); }

 private:
  Duration ahead() const { return Duration(ahead_ns_.load()); }

  drivers::MonotonicClock machine_;
  std::atomic<int64_t> ahead_ns_{0};
  std::atomic<int64_t> suspended_ns_{0};
};

}  // namespace bevloc::evaluation
