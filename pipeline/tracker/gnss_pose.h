// Converts a GNSS sample to the pose and the sigmas that the tracker works with.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/se2.h"
#include "common/vehicle_samples.h"

namespace bevloc {

struct GnssPose {
  Se2 map_from_vehicle;           ///< the yaw is not wrapped
  double position_sigma_m = 0.0;  ///< the larger sigma of the sample, for both axes
  double yaw_sigma_rad = 0.0;     ///< pi if the yaw is unknown
  bool has_yaw = false;
};

/// A yaw with a larger sigma counts as unknown.
inline constexpr double kLargestYawSigma_rad = 1.0;

/// Whether the yaw is known. A yaw whose sigma is not finite counts as known, so that the tracker
/// refuses the sample.
inline bool is_known(const std::optional<GnssSample::Yaw>& yaw) {
  return yaw && !(std::isfinite(yaw->sigma_rad) && yaw->sigma_rad >= kLargestYawSigma_rad);
}

inline GnssPose gnss_pose(const GnssSample& sample) {
  const bool has_yaw = is_known(sample.yaw);
  const GnssSample::Yaw yaw = has_yaw ? *sample.yaw : GnssSample::Yaw{0.0, std::numbers::pi};
  return {.map_from_vehicle = {sample.east_m, sample.north_m, yaw.yaw_rad},
          .position_sigma_m = std::max(sample.sigma_east_m, sample.sigma_north_m),
          .yaw_sigma_rad = yaw.sigma_rad,
          .has_yaw = has_yaw};
}

/// Moves the position of an antenna to the middle of the rear axle. The vehicle's yaw is that of
/// `estimate` or of the sample, whichever is more certain. The sigmas grow by the uncertainty of
/// the yaw times the distance, or by the distance if the yaw is not known.
inline GnssSample at_rear_axle(GnssSample sample, const std::optional<GnssSample::Yaw>& estimate) {
  if (!sample.antenna) return sample;
  const GnssSample::Antenna antenna = *sample.antenna;
  sample.antenna.reset();
  std::optional<GnssSample::Yaw> yaw = sample.yaw;
  if (estimate && (!yaw || estimate->sigma_rad < yaw->sigma_rad)) yaw = estimate;
  const double distance_m = std::hypot(antenna.x_m, antenna.y_m);
  const double sigma_m = is_known(yaw) ? yaw->sigma_rad * distance_m : distance_m;
  if (is_known(yaw)) {
    const double c = std::cos(yaw->yaw_rad);
    const double s = std::sin(yaw->yaw_rad);
    sample.east_m -= c * antenna.x_m - s * antenna.y_m;
    sample.north_m -= s * antenna.x_m + c * antenna.y_m;
  }
  sample.sigma_east_m = std::hypot(sample.sigma_east_m, sigma_m);
  sample.sigma_north_m = std::hypot(sample.sigma_north_m, sigma_m);
  return sample;
}

}  // namespace bevloc
