// Converts a GNSS sample to the pose and the sigmas that the tracker works with.
#pragma once

#include <algorithm>
#include <numbers>

#include "common/se2.h"
#include "common/vehicle_samples.h"

namespace bevloc {

struct GnssPose {
  Se2 map_from_vehicle;           ///< the yaw is not wrapped
  double position_sigma_m = 0.0;  ///< for both axes: the larger sigma of the sample
  double yaw_sigma_rad = 0.0;     ///< pi if the sample has no yaw
  bool has_yaw = false;
};

inline GnssPose gnss_pose(const GnssSample& sample) {
  const GnssSample::Yaw unknown{0.0, std::numbers::pi};
  const GnssSample::Yaw yaw = sample.yaw.value_or(unknown);
  return {.map_from_vehicle = {sample.east_m, sample.north_m, yaw.yaw_rad},
          .position_sigma_m = std::max(sample.sigma_east_m, sample.sigma_north_m),
          .yaw_sigma_rad = yaw.sigma_rad,
          .has_yaw = sample.yaw.has_value()};
}

}  // namespace bevloc
