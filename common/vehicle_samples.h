// Odometry and GNSS samples from the vehicle's own sensors.
#pragma once

#include <optional>
#include <variant>

#include "common/time.h"

namespace bevloc {

/// Motion of the middle of the rear axle.
struct OdometrySample {
  Time time{};                  ///< when the sample arrived
  double speed_mps = 0.0;       ///< along x, negative when reversing
  double yaw_rate_radps = 0.0;  ///< positive counter-clockwise
  /// How much faster than `yaw_rate_radps` the vehicle turns according to its wheels: mean of about
  /// the last second, in standard deviations. It is empty while a bias of 1 degree/s would not be
  /// noticeable.
  std::optional<double> wheel_lean{};
  /// Whether noise changes speed or yaw rate from sample to sample while the vehicle drives. If the
  /// bus carries both in coarse steps, equal samples in a row are normal.
  bool has_fine_steps = true;
};

/// Position in the map frame, of the middle of the rear axle or of an antenna. Each sigma is one
/// standard deviation.
struct GnssSample {
  struct Yaw {
    double yaw_rad = 0.0;  ///< counter-clockwise from the map's east
    double sigma_rad = 0.0;
  };

  /// The place of an antenna in the vehicle frame, seen from above.
  struct Antenna {
    double x_m = 0.0;
    double y_m = 0.0;
  };

  Time time{};  ///< when the vehicle was there; for a sample from the bus, when it arrived
  double east_m = 0.0;
  double north_m = 0.0;
  double sigma_east_m = 0.0;
  double sigma_north_m = 0.0;
  std::optional<Yaw> yaw{};  ///< empty when the receiver has no heading
  /// The antenna whose position this is. It is empty if this is the position of the rear axle.
  std::optional<Antenna> antenna{};
};

using VehicleSample = std::variant<OdometrySample, GnssSample>;

}  // namespace bevloc
