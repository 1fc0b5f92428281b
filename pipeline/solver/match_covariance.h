// Estimates the covariance of a match from the structure of the features.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc {

/// Treats the match as a least-squares fit of the moved BEV features B to the map features M, with
/// the hypothesis grid as prior:
///
///   covariance = (H S^-1 H (1 - 4 / blocks) + U^-1)^-1.
///
/// - H = J_M^T J_B, symmetrised, is the curvature of the score before normalisation. J_M and J_B
///   are the gradients of M and B by (x, y, yaw). Noise on one side alone cancels.
/// - S is the covariance of the score's slope: the sum over blocks of g g^T, g = J_M^T (M - B) (the
///   cluster-robust "sandwich" estimator). Errors may be correlated in any way inside a block of
///   6 m and between channels.
/// - U holds the variances of uniform hypotheses. Along a direction without structure, H vanishes
///   and U remains. A normalised score cannot detect this; its peak there is sharp and wrong.
///
/// The constructor allocates all memory. One thread.
class MatchCovariance {
 public:
  MatchCovariance(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);

  /// Covariance (x m, y m, yaw rad) of `correction`. It is always positive definite. `bev` and
  /// `map` are standardised features; `bev` has a margin for the hypotheses.
  Eigen::Matrix3d estimate(const CellFeatures& bev, const CellFeatures& map, const Se2& correction);

  /// The BEV features as the latest estimate() moved them, [row, col, lanes].
  const LaneBuffer& moved() const { return moved_; }
  /// Cells at each edge that a hypothesis can move out of the grid.
  int border() const { return border_; }

 private:
  struct Information {
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  ///< H
    Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();      ///< S
  };

  void add_block(const CellFeatures& map, const Se2& correction, int first_row, int first_col,
                 Information& information) const;

  BevGrid grid_;
  int border_;
  Eigen::Vector3d uniform_variance_;
  LaneBuffer moved_;
};

}  // namespace bevloc
