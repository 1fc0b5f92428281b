// Zero-padded ZNCC of one correction at a time.
#pragma once

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"
#include "pipeline/solver/match_sums.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// Sums over the lattice's cells of the map and of the features that a correction has moved. They
/// are moved and matched in one go, and nothing is written.
MatchSums match_moved(const CellFeatures& bev, const CellFeatures& map, const Se2& correction,
                      const CellLattice& lattice = kEveryCell);

/// Scores corrections by ZNCC over the lattice's cells and all channels (paper, eq. 5), with zeros
/// where the moved vehicle features do not reach, like TranslationScorer: this one serves
/// corrections that share nothing.
class PoseScorer {
 public:
  /// Both must outlive the scorer.
  PoseScorer(const CellFeatures& bev, const CellFeatures& map,
             const CellLattice& lattice = kEveryCell);

  double score(const Se2& correction) const;

 private:
  const CellFeatures& bev_;
  const CellFeatures& map_;
  CellLattice lattice_;
  double count_;  ///< values that are compared
  FeatureMoments map_moments_;
};

}  // namespace bevloc
