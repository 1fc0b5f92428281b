#include "firmware/gnss_monitor.h"

namespace bevloc::firmware {

void GnssMonitor::add(const GnssSample& sample, const TrackedPose& pose) {
  const double heading_rad = wrap_angle(sample.heading_rad - pose.map_from_vehicle.yaw_rad);
  const Eigen::Vector2d offset_m = sample.position_m - pose.map_from_vehicle.translation();
  const double squared_distance =
      offset_m.squaredNorm() / (sample.position_sigma_m * sample.position_sigma_m) +
      heading_rad * heading_rad / (sample.heading_sigma_rad * sample.heading_sigma_rad);
  mean_squared_distance_ += kGain * (squared_distance - mean_squared_distance_);
}

}  // namespace bevloc::firmware
