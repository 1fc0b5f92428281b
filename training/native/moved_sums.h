// The gradient of the sums that make up the ZNCC of moved features (match_moved() of
// pipeline/solver/pose_scorer.h).
#pragma once

#include <span>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"
#include "pipeline/solver/match_sums.h"

namespace bevloc {

/// A correction and the derivatives of a loss by its sums.
struct MovedSlope {
  Se2 correction;
  MatchSums slope;
};

/// Adds the gradients of the loss with respect to both sides to `grad_bev` and `grad_map`.
/// `grad_bev` must have the margin of `bev`. Its margin cells and the lanes beyond the channels get
/// unspecified values.
void add_moved_gradients(const CellFeatures& bev, const CellFeatures& map,
                         std::span<const MovedSlope> slopes, const CellLattice& lattice,
                         CellFeatures& grad_bev, CellFeatures& grad_map);

}  // namespace bevloc
