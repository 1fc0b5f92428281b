#include "evaluation/baselines/pose_least_squares.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace bevloc::evaluation {
namespace {

/// The information of a uniform distribution over -range ... +range.
double uniform_information(const HypothesisAxis& axis) {
  return 3.0 / (axis.range * axis.range);
}

Eigen::Vector3d prior_information(const HypothesisGrid& ranges) {
  return {uniform_information(ranges.x_m), uniform_information(ranges.y_m),
          uniform_information(ranges.yaw_rad)};
}

double within(const HypothesisAxis& axis, double value) {
  return std::clamp(value, -axis.range, axis.range);
}

}  // namespace

void PoseLeastSquares::add(const Eigen::Vector2d& moved, double residual_m,
                           const Eigen::Vector2d& gradient, double weight) {
  const Eigen::Vector2d arm = moved - around_.translation();
  const Eigen::Vector3d row(gradient.x(), gradient.y(),
                            gradient.y() * arm.x() - gradient.x() * arm.y());
  information_ += weight * kPointInformation * row * row.transpose();
  gradient_ += weight * kPointInformation * residual_m * row;
}

void PoseLeastSquares::add_prior(const HypothesisGrid& ranges) {
  const Eigen::Vector3d information = prior_information(ranges);
  information_.diagonal() += information;
  gradient_ += information.cwiseProduct(Eigen::Vector3d(around_.x_m, around_.y_m, around_.yaw_rad));
}

Se2 PoseLeastSquares::solve(const HypothesisGrid& ranges, double damping) const {
  Eigen::Matrix3d damped = information_;
  damped.diagonal() *= 1.0 + damping;
  const Eigen::Vector3d step = damped.ldlt().solve(-gradient_);
  return {within(ranges.x_m, around_.x_m + step.x()), within(ranges.y_m, around_.y_m + step.y()),
          within(ranges.yaw_rad, around_.yaw_rad + step.z())};
}

double prior_cost(const Se2& correction, const HypothesisGrid& ranges) {
  const Eigen::Vector3d c(correction.x_m, correction.y_m, correction.yaw_rad);
  return c.cwiseProduct(c).dot(prior_information(ranges));
}

}  // namespace bevloc::evaluation
