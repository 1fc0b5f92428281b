#include "pipeline/solver/pose_scorer.h"

#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"

namespace bevloc {
namespace {

/// Cells that are summed in float before the sums go to double, to limit rounding errors.
constexpr int kCellsPerFloatSum = 500;

/// Rows begin ... end - 1.
struct RowRange {
  int begin;
  int end;
};

/// Up to kLanes cells of one row: where the BEV features are read, and the first map cell.
struct CellGroup {
  Taps taps;
  const float* map;
  int cells;
};

/// Iterates over the cells of a lattice in groups, row by row.
class CellGroups {
 public:
  CellGroups(const FeatureWarp& moved, const CellFeatures& map, const CellLattice& lattice,
             const RowRange& rows)
      : moved_(moved), map_(map), lattice_(lattice), row_(rows.begin), row_end_(rows.end) {
    begin_row();
  }

  /// Floats between the map features of neighbouring cells of a group.
  int map_step() const { return lattice_.step * map_.lanes(); }
  const WarpLine& line() const { return line_; }

  /// Writes the next group. False after the last one.
  bool next(CellGroup& group) {
    if (first_ >= line_.cells) {
      if (++row_ >= row_end_) return false;
      begin_row();
    }
    line_.find_taps(first_, group.taps);
    group.map = map_.cell(row_, lattice_.first_col(row_)) + first_ * map_step();
    group.cells = std::min(kLanes, line_.cells - first_);
    first_ += kLanes;
    return true;
  }

 private:
  void begin_row() {
    line_ = moved_.line(row_, lattice_.first_col(row_), lattice_.cells(row_, map_.grid().cols),
                        lattice_.step);
    first_ = 0;
  }

  const FeatureWarp& moved_;
  const CellFeatures& map_;
  const CellLattice& lattice_;
  int row_;
  int row_end_;
  WarpLine line_;
  int first_;
};

/// Separate sums for even and odd cells, to hide the latency of the additions.
struct CellSums {
  LaneSums even;
  LaneSums odd;
};

/// `lanes_per_cell` is map.lanes(). A constant lets the compiler unroll the inner loop.
[[gnu::always_inline]] inline void add_cells(const CellGroup& group, WarpLine line, int map_step,
                                             int lanes_per_cell, CellSums& sums) {
  line.lanes = lanes_per_cell;
  const float* map = group.map;
  Lanes moved;
  int i = 0;
  for (; i + 1 < group.cells; i += 2, map += 2 * map_step) {
    for (int k = 0; k < lanes_per_cell; k += kLanes) {
      line.read(group.taps, i, k, moved);
      sums.even.add(lanes(map + k), moved);
      line.read(group.taps, i + 1, k, moved);
      sums.odd.add(lanes(map + map_step + k), moved);
    }
  }
  for (; i < group.cells; ++i, map += map_step) {
    for (int k = 0; k < lanes_per_cell; k += kLanes) {
      line.read(group.taps, i, k, moved);
      sums.even.add(lanes(map + k), moved);
    }
  }
}

/// Finds the taps of the next group before it adds the current one, so that the two overlap.
[[gnu::always_inline]] inline MatchSums add_groups(CellGroups& groups, int lanes_per_cell) {
  CellSums sums;
  CellGroup two[2];
  bool more = groups.next(two[0]);
  for (int i = 0; more; i = 1 - i) {
    more = groups.next(two[1 - i]);
    add_cells(two[i], groups.line(), groups.map_step(), lanes_per_cell, sums);
  }
  return sum_of(sums.even, sums.odd);
}

BEVLOC_TARGET_CLONES MatchSums match_rows(const FeatureWarp& moved, const CellFeatures& map,
                                          const CellLattice& lattice, const RowRange& rows) {
  CellGroups groups(moved, map, lattice, rows);
  return map.lanes() == kLanes ? add_groups(groups, kLanes) : add_groups(groups, map.lanes());
}

}  // namespace

MatchSums match_moved(const CellFeatures& bev, const CellFeatures& map, const Se2& correction,
                      const CellLattice& lattice) {
  const BevGrid& grid = map.grid();
  const FeatureWarp moved(bev, correction);
  const int rows_per_sum = std::max(1, kCellsPerFloatSum / lattice.cells(0, grid.cols));
  MatchSums sums;
  for (int row = 0; row < grid.rows; row += rows_per_sum) {
    sums += match_rows(moved, map, lattice, {row, std::min(row + rows_per_sum, grid.rows)});
  }
  return sums;
}

PoseScorer::PoseScorer(const CellFeatures& bev, const CellFeatures& map, const CellLattice& lattice)
    : bev_(bev),
      map_(map),
      lattice_(lattice),
      count_(static_cast<double>(lattice.cells(map.grid())) * map.channels()),
      map_moments_(moments_of(map, lattice)) {}

double PoseScorer::score(const Se2& correction) const {
  return zncc(match_moved(bev_, map_, correction, lattice_), map_moments_, count_);
}

}  // namespace bevloc
