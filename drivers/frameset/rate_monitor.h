// Detects cameras whose frame rate drifts against the other cameras.
#pragma once

#include <array>
#include <optional>

#include <boost/circular_buffer.hpp>

#include "common/cameras.h"
#include "common/time.h"

namespace bevloc::drivers {

/// The frame rate of a camera, relative to the median camera.
struct CameraDrift {
  double ppm = 0.0;  ///< positive if the camera delivers more frames per second
  double sigma_ppm = 0.0;
  /// Whether the drift exceeds the limit by more than its uncertainty (3 sigma).
  bool certain() const;
};

/// Fits a straight line through the times of the latest frames of each camera. Its slope is the
/// period. Missing frames do no harm, because the interval between two frames counts as the nearest
/// whole number of periods. Uses no clock. Allocates in its constructor only. The computation takes
/// about five microseconds per 32 frames of a camera. One thread.
class RateMonitor {
 public:
  /// The limit of the drift. Quartz crystals of the same kind differ by less. 25 ppm are 1.5 ms per
  /// minute.
  static constexpr double kLimit_ppm = 25.0;
  /// Number of frames of each camera that are kept, and the minimum for an estimate.
  static constexpr int kWindow = 256;
  static constexpr int kFewest = 64;
  /// The minimum number of cameras, because with fewer it is unknown which of them drifts.
  static constexpr int kFewestCameras = 3;

  /// Adds the time of a frame. The times of one camera must increase.
  void add(int camera, Time time);

  /// Returns the drift. It is empty while there are too few frames, no steady rate, or too few
  /// cameras.
  const std::optional<CameraDrift>& drift(int camera) const { return drifts_[camera]; }

 private:
  struct Period {
    double seconds = 0.0;
    double sigma = 0.0;
  };
  struct Track {
    boost::circular_buffer<Time> times{kWindow};
    int frames_since_fit = 0;
    std::optional<Period> period;
  };

  std::optional<Period> fit(const Track& track);
  void compare();

  std::array<Track, kCameraCount> tracks_{};
  std::array<Duration, kWindow> intervals_{};  ///< working memory of fit()
  std::array<std::optional<CameraDrift>, kCameraCount> drifts_{};
};

}  // namespace bevloc::drivers
