// The gradient of what a ZNCC of moved features is made of.
#pragma once

#include <span>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"
#include "pipeline/solver/match_sums.h"

namespace bevloc {

/// A correction, and how much some value grows with each of its sums (match_moved()).
struct MovedSlope {
  Se2 correction;
  MatchSums slope;
};

/// Adds the gradients of that value with respect to both sides. `grad_bev` has the margin of `bev`;
/// its cells in the margin, and lanes beyond the channels, are filled with what nothing reads.
void add_moved_gradients(const CellFeatures& bev, const CellFeatures& map,
                         std::span<const MovedSlope> slopes, const CellLattice& lattice,
                         CellFeatures& grad_bev, CellFeatures& grad_map);

}  // namespace bevloc
