// Finds how the other axes must follow when one axis moves, so that the score falls least.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc {

/// If one axis moves alone, the score may fall only because the other axes no longer fit: on a
/// curve, a step along the road requires a rotation. The valley is computed from the map features.
/// Near the solution the score falls like d^T H d for a displacement d = (x m, y m, yaw rad), with
/// H = sum over cells and channels of J^T J and J the gradients of the map features by the pose.
class ScoreValley {
 public:
  /// `map` holds standardised features; it is not kept.
  ScoreValley(const CellFeatures& map, const HypothesisGrid& hypotheses);

  /// The displacement that moves x by 1 m, with the best y and yaw for it. The rotation is about
  /// the corrected position of the vehicle.
  Eigen::Vector3d along_x(const Se2& correction) const;

  /// The displacement that rotates by 1 rad, with the best y for it and an unchanged x.
  Eigen::Vector3d along_yaw(const Se2& correction) const;

 private:
  Eigen::Matrix3d curvature_at(const Se2& correction) const;

  Eigen::Vector3d unit_;       ///< standard deviations of uniform hypotheses
  Eigen::Matrix3d curvature_;  ///< H for rotations about the centre of the grid
};

}  // namespace bevloc
