#include "pipeline/calibration/online/motion_direction.h"

#include <cmath>

namespace bevloc {

std::optional<double> MotionDirection::add(const Se2& map_from_vehicle,
                                           const std::optional<Se2>& motion) {
  if (samples_.empty() || !motion || samples_.full()) {
    begin(map_from_vehicle);
    return std::nullopt;
  }
  samples_.push_back({map_from_vehicle, samples_.back().driven * *motion});
  length_m_ += motion->translation().norm();
  if (length_m_ < kStretch_m) return std::nullopt;
  const double result_rad = turn();
  begin(map_from_vehicle);
  return result_rad;
}

void MotionDirection::begin(const Se2& map_from_vehicle) {
  samples_.clear();
  samples_.push_back({map_from_vehicle, Se2()});
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
