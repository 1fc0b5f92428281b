#include "training/native/moved_sums.h"

#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"

namespace bevloc {
namespace {

/// The slopes of a correction's sums.
struct LineSlope {
  float product;
  float value;
  float twice_square;
};

/// A line of cells of both sides, the map's `map_step` floats apart; `grad_bev` is to the gradient
/// what line.origin is to features.
struct GradientLine {
  WarpLine line;
  LineSlope slope;
  const float* map;
  int map_step;
  float* grad_bev;
  float* grad_map;
};

/// Adds `gradient` to the four cells that position `i` was read from, by their weights.
[[gnu::always_inline]] inline void scatter(const WarpLine& line, const Taps& taps, int i, int k,
                                           const Lanes& gradient, float* origin) {
  float* first = origin + taps.offset[i] + k;
  float* second = first + line.row_stride;
  const Lanes lower = taps.u[i] * gradient;
  const Lanes upper = gradient - lower;
  const Lanes far_upper = taps.v[i] * upper;
  const Lanes far_lower = taps.v[i] * lower;
  lanes(first) += upper - far_upper;
  lanes(first + line.lanes) += far_upper;
  lanes(second) += lower - far_lower;
  lanes(second + line.lanes) += far_lower;
}

/// `lanes_per_cell` is line.lanes, known to the compiler where it can be.
[[gnu::always_inline]] inline void add_cells(GradientLine cells, int lanes_per_cell) {
  WarpLine& line = cells.line;
  line.lanes = lanes_per_cell;
  const auto [product, value, twice_square] = cells.slope;
  Lanes moved;
  TapGroups groups(line);
  for (int first = 0; first < line.cells; first += kLanes) {
    const Taps& taps = groups.next();
    const int count = std::min(kLanes, line.cells - first);
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < lanes_per_cell; k += kLanes) {
        line.read(taps, i, k, moved);
        lanes(cells.grad_map + k) += product * moved;
        const Lanes gradient = product * lanes(cells.map + k) + (value + twice_square * moved);
        scatter(line, taps, i, k, gradient, cells.grad_bev);
      }
      cells.map += cells.map_step;
      cells.grad_map += cells.map_step;
    }
  }
}

BEVLOC_TARGET_CLONES void add_line(const GradientLine& cells) {
  cells.line.lanes == kLanes ? add_cells(cells, kLanes) : add_cells(cells, cells.line.lanes);
}

}  // namespace

void add_moved_gradients(const CellFeatures& bev, const CellFeatures& map,
                         std::span<const MovedSlope> slopes, const CellLattice& lattice,
                         CellFeatures& grad_bev, CellFeatures& grad_map) {
  const BevGrid& grid = map.grid();
  // Row by row, so that what the corrections read and write stays in the cache.
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
