#include "pipeline/online_calibration/motion_direction.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace bevloc {
namespace {

constexpr int kFitSteps = 3;
/// Errors of matched positions, one sigma. They stay alike for some seconds. Therefore
/// kAlikeSamples samples count as one.
constexpr double kAcross_m = 0.08;
constexpr double kAlong_m = 0.3;
constexpr double kAlikeSamples = 15.0;
/// Error that the matched headings of a stretch have in common, one sigma.
constexpr double kHeading_rad = radians(0.2);

}  // namespace

std::optional<HeadingTurn> MotionDirection::add(const std::optional<Se2>& map_from_vehicle,
                                                const std::optional<DrivenStep>& step) {
  const bool paused = step && sampled_ && step->to - *sampled_ > kLongestPause;
  if (!step || step->from != driven_until_ || samples_.full() || paused) begin();
  driven_until_.reset();
  if (step) {
    driven_ = driven_ * step->motion;
    length_m_ += step->motion.translation().norm();
    driven_until_ = step->to;
  }
  if (map_from_vehicle) {
    samples_.push_back({*map_from_vehicle, driven_});
    sampled_ = driven_until_;
  }
  if (length_m_ < kStretch_m || samples_.size() < kLeastPoses) return std::nullopt;
  const HeadingTurn result = turn();
  begin();
  return result;
}

void MotionDirection::begin() {
  samples_.clear();
  driven_ = Se2();
  length_m_ = 0.0;
  sampled_.reset();
}

/// Lays the driven path over the matched positions, by weighted least squares. Matches are several
/// times less exact along the road, so this direction has less weight. With equal weights, its
/// errors would turn the whole path where the road bends.
HeadingTurn MotionDirection::turn() const {
  const Se2 first = samples_.front().matched * samples_.front().driven.inverse();
  double map_from_driven_rad = first.yaw_rad;
  Eigen::Vector2d map_from_driven_m = first.translation();
  double fit_variance = 0.0;
  for (int step = 0; step < kFitSteps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Sample& sample : samples_) {
      const Eigen::Vector2d turned =
          Eigen::Rotation2Dd(map_from_driven_rad) * sample.driven.translation();
      const Eigen::Matrix2d map_from_axes =
          Eigen::Rotation2Dd(map_from_driven_rad + sample.driven.yaw_rad).toRotationMatrix();
      const Eigen::Matrix2d in_sigmas =
          Eigen::Vector2d(1.0 / kAlong_m, 1.0 / kAcross_m).asDiagonal() * map_from_axes.transpose();
      Eigen::Matrix<double, 2, 3> slope;
      slope << in_sigmas, in_sigmas * Eigen::Vector2d(-turned.y(), turned.x());
      normal += slope.transpose() * slope;
      right += slope.transpose() *
               (in_sigmas * (sample.matched.translation() - map_from_driven_m - turned));
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d change = solver.solve(right);
    map_from_driven_m += change.head<2>();
    map_from_driven_rad += change.z();
    fit_variance = solver.solve(Eigen::Vector3d::UnitZ()).z();
  }
  double sum_rad = 0.0;
  for (const Sample& sample : samples_) {
    sum_rad += wrap_angle(sample.matched.yaw_rad - sample.driven.yaw_rad - map_from_driven_rad);
  }
  return {sum_rad / static_cast<double>(samples_.size()),
          kAlikeSamples * fit_variance + kHeading_rad * kHeading_rad};
}

}  // namespace bevloc
