// What the vehicle's own sensors tell the localizer.
#pragma once

#include <optional>

#include "common/time.h"

namespace bevloc::can {

/// The motion of the middle of the rear axle.
struct OdometrySample {
  Time time{};  ///< of arrival
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;  ///< positive counter-clockwise
};

/// A position of the middle of the rear axle in the map frame; sigmas are one standard deviation.
struct GnssSample {
  struct Yaw {
    double yaw_rad = 0.0;  ///< counter-clockwise from the map's east
    double sigma_rad = 0.0;
  };

  Time time{};  ///< of arrival
  double east_m = 0.0;
  double north_m = 0.0;
  double sigma_east_m = 0.0;
  double sigma_north_m = 0.0;
  std::optional<Yaw> yaw{};
};

}  // namespace bevloc::can
