// Least squares over a pose in the plane, for all baselines.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc::evaluation {

/// Information of one point, 1/m^2: a perceived line has an error of about 0.3 m, which 20
/// neighbouring points (3 m of the line) share.
inline constexpr double kPointInformation = 1.0 / (0.3 * 0.3 * 20.0);

/// The problem, linearised around a correction. Parameters: x, y and yaw.
class PoseLeastSquares {
 public:
  explicit PoseLeastSquares(const Se2& around) : around_(around) {}

  /// Adds the squared distance of a point from its line. `moved` is the point under the correction,
  /// `residual_m` its distance, and `gradient` the derivative of the distance by the point's
  /// position.
  void add(const Eigen::Vector2d& moved, double residual_m, const Eigen::Vector2d& gradient,
           double weight);

  /// Adds the prior: mean zero, and the variance of a uniform distribution over the ranges.
  void add_prior(const HypothesisGrid& ranges);

  /// The correction with the lowest cost, clamped to the ranges. `damping` is that of
  /// Levenberg-Marquardt; 0 gives Gauss-Newton.
  Se2 solve(const HypothesisGrid& ranges, double damping) const;

 private:
  Se2 around_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient_ = Eigen::Vector3d::Zero();
};

/// The prior's part of the sum of weighted squares.
double prior_cost(const Se2& correction, const HypothesisGrid& ranges);

}  // namespace bevloc::evaluation
