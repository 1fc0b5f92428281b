// Carries the kernel's and the controller's time stamps over to the steady clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::can {

/// What came with a frame, each as time since the zero of its own clock.
struct KernelStamps {
  std::optional<std::chrono::nanoseconds>
      software{};  ///< CLOCK_REALTIME, by the driver's interrupt
  std::optional<std::chrono::nanoseconds> hardware{};  ///< the controller's own free-running clock
};

enum class StampSource : uint8_t { kHardware, kSoftware, kArrival };

/// One thread at a time.
class ReceiveClock {
 public:
  /// Both clocks, read at the same moment, after the frame was.
  struct Now {
    Time steady{};
    std::chrono::nanoseconds realtime{};
  };
  struct Stamped {
    Time time{};
    StampSource source = StampSource::kArrival;
  };

  /// When the frame was received: by hardware if it says so, else by the kernel, else now. Never
  /// after `now` and never before the frame before, whatever is done to the other clocks.
  Stamped to_steady(const KernelStamps& stamps, const Now& now);

 private:
  Time from_hardware(std::chrono::nanoseconds hardware, Time by_kernel);

  std::optional<Duration> steady_minus_hardware_;
  std::chrono::nanoseconds last_hardware_{};
  Time last_ = Time::min();
};

}  // namespace bevloc::can
