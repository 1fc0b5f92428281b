// The latest pose with its uncertainty, for whoever shows or records it.
#pragma once

#include <array>

#include "common/se2.h"
#include "common/time.h"

namespace bevloc::firmware {

/// The pose of one bus cycle. It can be copied as bytes (Published).
struct PoseSnapshot {
  /// Whether the tracker has a pose. The fields below are zero without one.
  bool known = false;
  bool valid = false;  ///< a consumer may use it
  Time time{};         ///< the moment to which the pose is predicted
  Se2 map_from_vehicle;
  /// Sigmas along the vehicle's axes: (longitudinal m, lateral m, yaw rad). The protection levels
  /// have the same order.
  std::array<double, 3> sigma{};
  std::array<double, 3> protection_level{};
  double longitudinal_lateral_covariance_m2 = 0.0;
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

}  // namespace bevloc::firmware
