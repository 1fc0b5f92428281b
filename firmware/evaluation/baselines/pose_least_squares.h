// Least squares over a pose in the plane, as all baselines solve them.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/solver/solver.h"

namespace bevloc::evaluation {

/// What one point tells, per square metre: a perceived line is off by about 0.3 m, and 20 points in
/// a row (3 m of it) are off together.
inline constexpr double kPointInformation = 1.0 / (0.3 * 0.3 * 20.0);

/// The linearised problem around a correction; its parameters are x, y and yaw.
class PoseLeastSquares {
 public:
  explicit PoseLeastSquares(const Se2& around) : around_(around) {}

  /// The squared distance of a point to where it should lie. `moved` is the point under the
  /// correction, `residual_m` its distance, which grows by `slope` per metre of its motion.
  void add(const Eigen::Vector2d& moved, double residual_m, const Eigen::Vector2d& slope,
           double weight);

  /// The prior: the correction is around zero, with the deviations of a uniform one in the ranges.
  void add_prior(const HypothesisGrid& ranges);

  /// The correction that minimises it, kept within the ranges. `damping` is Levenberg's and
  /// Marquardt's; 0 is Gauss's and Newton's.
  Se2 solve(const HypothesisGrid& ranges, double damping) const;

 private:
  Se2 around_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient_ = Eigen::Vector3d::Zero();
};

/// What the prior adds to the sum of weighted squares.
double prior_cost(const Se2& correction, const HypothesisGrid& ranges);

}  // namespace bevloc::evaluation
