// Whose clock runs at another rate than the other cameras'.
#pragma once

#include <array>
#include <optional>

#include "common/time.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::drivers {

/// One camera's frame rate against the median camera's.
struct CameraDrift {
  double ppm = 0.0;  ///< more than 0: it takes more frames per second
  double sigma_ppm = 0.0;
  /// Whether it is beyond the limit, the uncertainty allowed for.
  bool certain() const;
};

/// Fits a straight line through the times of each camera's latest frames; its slope is the period.
/// Frames that are missing are no harm: an interval counts as the nearest whole number of periods.
/// No clock, no allocation; about five microseconds for every 32 frames of a camera.
class RateMonitor {
 public:
  /// Quartz crystals of one kind differ by less; 25 ppm are 1.5 ms a minute.
  static constexpr double kLimit_ppm = 25.0;
  /// Frames of each camera that are remembered, and the fewest that give an estimate.
  static constexpr int kWindow = 256;
  static constexpr int kFewest = 64;
  /// With fewer cameras nobody can say which of them is wrong.
  static constexpr int kFewestCameras = 3;

  /// Times of one camera grow.
  void add(int camera, Time time);

  /// Nothing while it is not known: too few frames, frames at no steady rate, too few cameras.
  const std::optional<CameraDrift>& drift(int camera) const { return drifts_[camera]; }

 private:
  struct Period {
    double seconds = 0.0;
    double sigma = 0.0;
  };
  struct Track {
    std::array<Time, kWindow> times;  ///< a ring
    int next = 0;
    int size = 0;
    int since_fit = 0;
    std::optional<Period> period;

    Time at(int i) const { return times[(next + kWindow - size + i) % kWindow]; }
    Duration newest_interval(Time time) const { return time - at(size - 1); }
  };

  std::optional<Period> fit(const Track& track);
  void compare();

  std::array<Track, kCameraCount> tracks_{};
  std::array<Duration, kWindow> intervals_{};  ///< of the track that is being fitted
  std::array<std::optional<CameraDrift>, kCameraCount> drifts_{};
};

}  // namespace bevloc::drivers
