// How far a match can be trusted: what the features themselves say about each direction.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// Covariance of a match as of a least-squares fit of the moved vehicle features B to the map
/// features M, with the hypothesis grid as prior:
///
///   covariance = (H S^-1 H (1 - 4 / blocks) + U^-1)^-1.
///
/// H = J_M^T J_B, symmetrised, is the curvature of the UN-normalised covariance score: J holds each
/// side's gradient by (x, y, yaw), and noise on one side alone cancels. S is the covariance of the
/// score's slope, sum over blocks of g g^T with g = J_M^T (M - B) (the cluster-robust "sandwich"):
/// errors may be correlated at will inside a block of 6 m, and between channels. U is the variance
/// of uniform hypotheses: where the scene has no structure along a direction, H vanishes there and
/// U is what remains. A normalised score cannot see that: it is confidently wrong there.
class MatchCovariance {
 public:
  MatchCovariance(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);

  /// Covariance (x m, y m, yaw rad) of `correction`, always positive definite.
  Eigen::Matrix3d estimate(const CellFeatures& bev, const CellFeatures& map, const Se2& correction);

 private:
  struct Information {
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  };

  void add_block(const CellFeatures& map, const Se2& correction, int first_row, int first_col,
                 Information& information) const;

  BevGrid grid_;
  int lanes_;
  int border_;  ///< cells that a hypothesis can move out of sight
  Eigen::Vector3d uniform_variance_;
  LaneBuffer moved_;  ///< the vehicle's features, moved: [row, col, lanes]
};

}  // namespace bevloc
