// Which way the score falls least when one axis is moved.
#pragma once

#include <Eigen/Core>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// Moving along one axis alone, the score may fall because the others no longer fit: on a curve, a
/// step along the road asks for a turn. The score's valley is found from the map's own features:
/// near the solution they fall like d^T H d for a displacement d = (x m, y m, yaw rad), with
/// H = sum over cells and channels of J^T J, J their gradients by the pose.
class ScoreValley {
 public:
  ScoreValley(const CellFeatures& map, const HypothesisGrid& hypotheses);

  /// The displacement that moves x by 1 m, with the y and the yaw that suit it best. The turn is
  /// about the vehicle's corrected position.
  Eigen::Vector3d along_x(const Se2& correction) const;

  /// The displacement that turns by 1 rad, with the y that suits it best, and the same x.
  Eigen::Vector3d along_yaw(const Se2& correction) const;

 private:
  Eigen::Matrix3d curvature_at(const Se2& correction) const;

  Eigen::Vector3d unit_;       ///< the hypotheses' deviations
  Eigen::Matrix3d curvature_;  ///< H with turns about the map's middle
};

}  // namespace bevloc
