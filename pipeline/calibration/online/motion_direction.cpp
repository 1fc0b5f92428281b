#include "pipeline/calibration/online/motion_direction.h"

#include <cmath>

namespace bevloc {

std::optional<double> MotionDirection::add(const std::optional<Se2>& map_from_vehicle,
                                           const std::optional<Se2>& motion) {
  if (!motion || samples_.full()) begin();
  if (motion) {
    driven_ = driven_ * *motion;
    length_m_ += motion->translation().norm();
  }
  if (map_from_vehicle) samples_.push_back({*map_from_vehicle, driven_});
  if (length_m_ < kStretch_m) return std::nullopt;
  std::optional<double> result_rad;
  if (samples_.size() >= kLeastPoses) result_rad = turn();
  begin();
  return result_rad;
}

void MotionDirection::begin() {
  samples_.clear();
  driven_ = Se2();
  length_m_ = 0.0;
}

double MotionDirection::turn() const {
  const auto count = static_cast<double>(samples_.size());
  Eigen::Vector2d matched_middle = Eigen::Vector2d::Zero();
  Eigen::Vector2d driven_middle = Eigen::Vector2d::Zero();
  for (const Sample& sample : samples_) {
    matched_middle += sample.matched.translation() / count;
    driven_middle += sample.driven.translation() / count;
  }
  // The rotation that lays the driven path over the matched positions with the least squares.
  double along = 0.0;
  double across = 0.0;
  for (const Sample& sample : samples_) {
    const Eigen::Vector2d matched = sample.matched.translation() - matched_middle;
    const Eigen::Vector2d driven = sample.driven.translation() - driven_middle;
    along += driven.dot(matched);
    across += driven.x() * matched.y() - driven.y() * matched.x();
  }
  const double map_from_driven_rad = std::atan2(across, along);
  double sum_rad = 0.0;
  for (const Sample& sample : samples_) {
    sum_rad += wrap_angle(sample.matched.yaw_rad - sample.driven.yaw_rad - map_from_driven_rad);
  }
  return sum_rad / count;
}

}  // namespace bevloc
