#include "pipeline/solver/pose_scorer.h"

#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"

namespace bevloc {
namespace {

/// Groups of kLanes cells that are summed in float before the sums go to double, to limit rounding
/// errors.
constexpr int kGroupsPerFloatSum = 32;

/// Separate sums for even and odd cells, to hide the latency of the additions.
struct CellSums {
  LaneSums even;
  LaneSums odd;
};

/// Groups of kLanes cells: the first one, and the end.
struct GroupRange {
  int begin;
  int end;
};

/// Adds `count` cells with the taps of their moved features. `lanes_per_cell` is map.lanes(). A
/// constant lets the compiler unroll the inner loop.
[[gnu::always_inline]] inline void add_cells(WarpSource source, const Taps& taps, const float* map,
                                             const LaneIntegers& map_offsets, int count,
                                             int lanes_per_cell, CellSums& sums) {
  source.lanes = lanes_per_cell;
  Lanes moved;
  for (int i = 0; i < count; i += 2) {
    for (int k = 0; k < lanes_per_cell; k += kLanes) {
      source.read(taps, i, k, moved);
      sums.even.add(lanes(map + map_offsets[i] + k), moved);
      if (i + 1 == count) continue;
      source.read(taps, i + 1, k, moved);
      sums.odd.add(lanes(map + map_offsets[i + 1] + k), moved);
    }
  }
}

/// Finds the taps of the next group before it adds the current one, so that the two overlap.
[[gnu::always_inline]] inline MatchSums add_groups(const WarpPlane& moved, const CellFeatures& map,
                                                   const LatticeCells& cells,
                                                   const GroupRange& groups, int lanes_per_cell) {
  CellSums sums;
  Taps two[2];
  const auto find_taps = [&](int group) {
    moved.find_taps(cells.rows(group), cells.cols(group), two[group % 2]);
  };
  find_taps(groups.begin);
  for (int group = groups.begin; group < groups.end; ++group) {
    if (group + 1 < groups.end) find_taps(group + 1);
    add_cells(moved.source, two[group % 2], map.cell(0, 0), cells.offsets(group),
              cells.count(group), lanes_per_cell, sums);
  }
  return sum_of(sums.even, sums.odd);
}

BEVLOC_TARGET_CLONES MatchSums match_groups(const WarpPlane& moved, const CellFeatures& map,
                                            const LatticeCells& cells, const GroupRange& groups) {
  return map.lanes() == kLanes ? add_groups(moved, map, cells, groups, kLanes)
                               : add_groups(moved, map, cells, groups, map.lanes());
}

}  // namespace

LatticeCells::LatticeCells(const CellFeatures& map, const CellLattice& lattice)
    : lattice_(lattice) {
  const BevGrid& grid = map.grid();
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = lattice.first_col(row); col < grid.cols; col += lattice.step) {
      rows_.push_back(static_cast<float>(row - 0.5 * (grid.rows - 1)));
      cols_.push_back(static_cast<float>(col - 0.5 * (grid.cols - 1)));
      offsets_.push_back(static_cast<int>(row * map.row_stride() + col * map.lanes()));
    }
  }
  cells_ = static_cast<int>(rows_.size());
  const auto whole_groups = static_cast<size_t>(round_up_to_lanes(cells_));
  rows_.resize(whole_groups);
  cols_.resize(whole_groups);
  offsets_.resize(whole_groups);
}

MatchSums match_moved(const CellFeatures& bev, const CellFeatures& map, const Se2& correction,
                      const LatticeCells& cells) {
  const WarpPlane moved = FeatureWarp(bev, correction).plane();
  MatchSums sums;
  for (int group = 0; group < cells.groups(); group += kGroupsPerFloatSum) {
    const int end = std::min(group + kGroupsPerFloatSum, cells.groups());
    sums += match_groups(moved, map, cells, {group, end});
  }
  return sums;
}

PoseScorer::PoseScorer(const CellFeatures& bev, const CellFeatures& map, const LatticeCells& cells)
    : bev_(bev),
      map_(map),
      cells_(cells),
      count_(static_cast<double>(cells.count()) * map.channels()),
      map_moments_(moments_of(map, cells.lattice())) {}

double PoseScorer::score(const Se2& correction) const {
  return zncc(match_moved(bev_, map_, correction, cells_), map_moments_, count_);
}

}  // namespace bevloc
