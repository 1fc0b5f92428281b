// Scores a match absolutely: how well the perceived features lie on the mapped ones.
#pragma once

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {

/// The overlap of both sides at a correction. The distributions of a match cannot give it: a
/// softmax compares hypotheses with each other, so some hypothesis always wins, also where the map
/// shows another place.
struct MatchScore {
  /// ZNCC of both sides over the inner cells and all channels, at least 0.
  double overlap = 0.0;
  /// Per axis (x, y, yaw): the cosine between both sides' gradients along the axis, at least 0.
  /// Stop lines and dash ends have a gradient along x, so the value of x is their overlap. The
  /// value of y is the overlap of lane lines and kerbs.
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
};

/// `moved` are the BEV features moved by `correction`, [row, col, lanes] on the grid of `map`. The
/// outer `border` cells at each edge (at least 1) are not used; it should cover what a correction
/// moves out of the grid. Both sides are standardised features. A side without structure scores 0.
MatchScore score_match(const CellFeatures& map, const LaneBuffer& moved, const Se2& correction,
                       int border);

}  // namespace bevloc
