// Where the time comes from: the machine's steady clock, or a test's virtual one.
#pragma once

#include "common/time.h"

namespace bevloc::drivers {

class Clock {
 public:
  virtual ~Clock() = default;

  virtual Time now() const = 0;

  /// Returns at `time` or later; at once if that has passed.
  virtual void sleep_until(Time time) = 0;
};

/// CLOCK_MONOTONIC, the clock of V4L2's frame stamps and of CAN's hardware-independent receive
/// times. Thread safe.
class MonotonicClock final : public Clock {
 public:
  Time now() const override;
  void sleep_until(Time time) override;
};

/// Time that stands still until somebody moves it; sleeping moves it. For lockstep drives and for
/// tests, both of one thread: it is not thread safe.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(Time start = Time{}) : now_(start) {}

  Time now() const override { return now_; }
  void sleep_until(Time time) override { now_ = time > now_ ? time : now_; }

  void advance(Duration duration);

 private:
  Time now_;
};

}  // namespace bevloc::drivers
