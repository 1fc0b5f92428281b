// Scores single corrections by zero-padded ZNCC over the cells of a lattice.
#pragma once

#include <algorithm>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"
#include "pipeline/solver/match_sums.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// The cells of a lattice, in groups of kLanes, the last one filled up with zeros. They are
/// computed once, because they are the same for every pose.
class LatticeCells {
 public:
  /// `map` says where its cells lie in memory; features of the same size may be scored.
  LatticeCells(const CellFeatures& map, const CellLattice& lattice);

  const CellLattice& lattice() const { return lattice_; }
  int count() const { return cells_; }
  int groups() const { return static_cast<int>(rows_.size()) / kLanes; }

  /// Number of cells in a group.
  int count(int group) const { return std::min(kLanes, cells_ - group * kLanes); }
  /// Rows and columns, counted from the middle of the grid.
  const Lanes& rows(int group) const { return lanes(&rows_[group * kLanes]); }
  const Lanes& cols(int group) const { return lanes(&cols_[group * kLanes]); }
  /// Floats from the features of cell (0, 0) to those of each cell.
  const LaneIntegers& offsets(int group) const {
    return *reinterpret_cast<const LaneIntegers*>(&offsets_[group * kLanes]);
  }

 private:
  CellLattice lattice_;
  int cells_ = 0;
  LaneBuffer rows_;
  LaneBuffer cols_;
  CacheLineVector<int> offsets_;
};

/// Moves the BEV features by `correction` and sums their products with the map features over the
/// cells. The moved features are used in registers and never stored.
MatchSums match_moved(const CellFeatures& bev, const CellFeatures& map, const Se2& correction,
                      const LatticeCells& cells);

/// Scores corrections by ZNCC over the cells of a lattice and all channels (paper, eq. 5). The
/// moved BEV features are zero outside their grid. reference/translation_scorer.h computes the same
/// score faster for many corrections with the same yaw.
class PoseScorer {
 public:
  /// All three must outlive the scorer.
  PoseScorer(const CellFeatures& bev, const CellFeatures& map, const LatticeCells& cells);

  double score(const Se2& correction) const;

 private:
  const CellFeatures& bev_;
  const CellFeatures& map_;
  const LatticeCells& cells_;
  double count_;  ///< cells of the lattice times channels
  FeatureMoments map_moments_;
};

}  // namespace bevloc
