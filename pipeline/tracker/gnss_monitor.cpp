#include "pipeline/tracker/gnss_monitor.h"

#include "pipeline/tracker/gnss_pose.h"

namespace bevloc {

void GnssMonitor::add(const GnssSample& sample, const TrackedPose& pose) {
  const GnssPose gnss = gnss_pose(sample);
  const double yaw_rad = wrap_angle(gnss.map_from_vehicle.yaw_rad - pose.map_from_vehicle.yaw_rad);
  const Eigen::Vector2d offset_m =
      gnss.map_from_vehicle.translation() - pose.map_from_vehicle.translation();
  const double squared_distance =
      offset_m.squaredNorm() / (gnss.position_sigma_m * gnss.position_sigma_m) +
      yaw_rad * yaw_rad / (gnss.yaw_sigma_rad * gnss.yaw_sigma_rad);
  mean_squared_distance_ += kGain * (squared_distance - mean_squared_distance_);
}

}  // namespace bevloc
