// Scores single corrections by zero-padded ZNCC.
#pragma once

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"
#include "pipeline/solver/match_sums.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// Moves the BEV features by `correction` and sums their products with the map features over the
/// cells of the lattice. The moved features are used in registers and never stored.
MatchSums match_moved(const CellFeatures& bev, const CellFeatures& map, const Se2& correction,
                      const CellLattice& lattice = kEveryCell);

/// Scores corrections by ZNCC over the cells of a lattice and all channels (paper, eq. 5). The
/// moved BEV features are zero outside their grid. reference/translation_scorer.h computes the same
/// score faster for many corrections with the same yaw.
class PoseScorer {
 public:
  /// `bev` and `map` must outlive the scorer.
  PoseScorer(const CellFeatures& bev, const CellFeatures& map,
             const CellLattice& lattice = kEveryCell);

  double score(const Se2& correction) const;

 private:
  const CellFeatures& bev_;
  const CellFeatures& map_;
  CellLattice lattice_;
  double count_;  ///< cells of the lattice times channels
  FeatureMoments map_moments_;
};

}  // namespace bevloc
