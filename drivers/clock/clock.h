// The source of time: the machine's steady clock or a virtual clock.
#pragma once

#include "common/time.h"

namespace bevloc::drivers {

class Clock {
 public:
  virtual ~Clock() = default;

  virtual Time now() const = 0;

  /// Returns at `time` or later, and immediately if `time` has passed.
  virtual void sleep_until(Time time) = 0;

  /// How long the machine was suspended since its start. now() stands still during a suspend.
  virtual Duration suspended() const = 0;

  /// The time since an arbitrary zero, at the rate of the hardware. The rate of now(), in contrast,
  /// changes while a time service corrects the system clock.
  virtual Duration unsteered() const = 0;
};

/// CLOCK_MONOTONIC, which is also the clock of V4L2's time stamps. Thread-safe.
class MonotonicClock final : public Clock {
 public:
  Time now() const override;
  void sleep_until(Time time) override;
  Duration suspended() const override;
  Duration unsteered() const override;
};

/// A clock for lockstep drives and tests, which only advance() and sleep_until() advance. One
/// thread.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(Time start = Time{}) : now_(start) {}

  Time now() const override { return now_; }
  void sleep_until(Time time) override { now_ = time > now_ ? time : now_; }

  Duration suspended() const override { return suspended_; }
  Duration unsteered() const override { return now_.time_since_epoch(); }

  void advance(Duration duration);
  /// Simulates that the machine was suspended.
  void suspend(Duration duration) { suspended_ += duration; }

 private:
  Time now_;
  Duration suspended_{};
};

}  // namespace bevloc::drivers
