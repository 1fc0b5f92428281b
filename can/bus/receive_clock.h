// Converts time stamps of the kernel and of the CAN controller to the steady clock.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::can {

/// The time stamps of one frame, each as the time since the epoch of its own clock.
struct KernelStamps {
  /// CLOCK_REALTIME, read in the driver's interrupt.
  std::optional<std::chrono::nanoseconds> software{};
  /// The controller's own free-running clock.
  std::optional<std::chrono::nanoseconds> hardware{};
};

enum class StampSource : uint8_t { kHardware, kSoftware, kArrival };

/// One thread.
class ReceiveClock {
 public:
  /// The times of both clocks at one moment after the frame was read.
  struct Now {
    Time steady{};
    std::chrono::nanoseconds realtime{};
  };
  struct Stamped {
    Time time{};
    StampSource source = StampSource::kArrival;
  };

  /// Returns when the frame was received, from the hardware stamp if there is one, else from the
  /// software stamp, else `now`. The result is never after `now` and never before the result of the
  /// previous frame. A step of CLOCK_REALTIME is noticed, and does not change the result.
  Stamped to_steady(const KernelStamps& stamps, const Now& now);

 private:
  /// Returns the age of a software stamp, or nothing if no frame can have this age.
  std::optional<Duration> age_of(std::chrono::nanoseconds software, const Now& now) const;
  void watch_realtime(const Now& now);
  Time from_hardware(std::chrono::nanoseconds hardware, Time by_kernel);

  std::optional<Duration> realtime_minus_steady_;  ///< the difference at the previous frame
  Time watched_{};                                 ///< when the previous frame came
  Duration latest_step_{};                         ///< the latest step of CLOCK_REALTIME
  std::optional<Time> stepped_;                    ///< when the latest step was noticed

  /// The smallest differences of steady and hardware time in the latest period with a frame and in
  /// the period before it. The controller's clock counts the periods.
  struct Offset {
    int64_t period = 0;
    Duration in_period{};
    Duration in_period_before{};

    Duration smallest() const { return std::min(in_period, in_period_before); }
  };
  std::optional<Offset> offset_;
  Time last_ = Time::min();
};

}  // namespace bevloc::can
