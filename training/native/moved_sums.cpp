#include "training/native/moved_sums.h"

#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"

namespace bevloc {
namespace {

/// The derivatives of the loss by the sums of one correction. That by the squares is doubled.
struct LineSlope {
  float product;
  float value;
  float twice_square;
};

/// A line of cells of both sides. The map's cells are `map_step` floats apart. `grad_bev` is the
/// counterpart of line.source.origin in the gradient.
struct GradientLine {
  WarpLine line;
  LineSlope slope;
  const float* map;
  int map_step;
  float* grad_bev;
  float* grad_map;
};

/// Adds `gradient`, weighted, to the four cells from which position `i` was interpolated.
[[gnu::always_inline]] inline void scatter(const WarpSource& source, const Taps& taps, int i, int k,
                                           const Lanes& gradient, float* origin) {
  float* upper = origin + taps.offset[i] + k;
  float* lower = upper + source.row_stride;
  lanes(upper) += taps.first[i] * gradient;
  lanes(upper + source.lanes) += taps.next_col[i] * gradient;
  lanes(lower) += taps.next_row[i] * gradient;
  lanes(lower + source.lanes) += taps.next_both[i] * gradient;
}

/// Adds the gradients of one line. `lanes_per_cell` equals source.lanes; a constant argument lets
/// the compiler specialise the loop.
[[gnu::always_inline]] inline void add_cells(GradientLine cells, int lanes_per_cell) {
  WarpLine& line = cells.line;
  line.source.lanes = lanes_per_cell;
  const auto [product, value, twice_square] = cells.slope;
  Lanes moved;
  TapGroups groups(line);
  for (int first = 0; first < line.cells; first += kLanes) {
    const Taps& taps = groups.next();
    const int count = std::min(kLanes, line.cells - first);
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < lanes_per_cell; k += kLanes) {
        line.source.read(taps, i, k, moved);
        lanes(cells.grad_map + k) += product * moved;
        const Lanes gradient = product * lanes(cells.map + k) + (value + twice_square * moved);
        scatter(line.source, taps, i, k, gradient, cells.grad_bev);
      }
      cells.map += cells.map_step;
      cells.grad_map += cells.map_step;
    }
  }
}

BEVLOC_TARGET_CLONES void add_line(const GradientLine& cells) {
  const int lanes_per_cell = cells.line.source.lanes;
  lanes_per_cell == kLanes ? add_cells(cells, kLanes) : add_cells(cells, lanes_per_cell);
}

}  // namespace

void add_moved_gradients(const CellFeatures& bev, const CellFeatures& map,
                         std::span<const MovedSlope> slopes, const CellLattice& lattice,
                         CellFeatures& grad_bev, CellFeatures& grad_map) {
  const BevGrid& grid = map.grid();
  // Rows are the outer loop, so that the data of one row stays in the cache for all corrections.
  for (int row = 0; row < grid.rows; ++row) {
    const int col = lattice.first_col(row);
    const int cells = lattice.cells(row, grid.cols);
    for (const auto& [correction, slope] : slopes) {
      add_line({.line = FeatureWarp(bev, correction).line(row, col, cells, lattice.step),
                .slope = {static_cast<float>(slope.product), static_cast<float>(slope.value),
                          static_cast<float>(2.0 * slope.square)},
                .map = map.cell(row, col),
                .map_step = lattice.step * map.lanes(),
                .grad_bev = grad_bev.mutable_cell(0, 0),
                .grad_map = grad_map.mutable_cell(row, col)});
    }
  }
}

}  // namespace bevloc
