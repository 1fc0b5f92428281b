// Cells of the map and of the moved BEV features side by side, and the slopes of their features.
#pragma once

#include <cstddef>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {

/// One cell on both sides. The next cell of its row follows after `lanes` floats.
struct CellRows {
  const float* map;
  const float* moved;
  std::ptrdiff_t map_row_stride;
  std::ptrdiff_t moved_row_stride;
  int lanes;
};

/// Both sides at a cell. `moved` is [row, col, lanes] on the grid of `map`.
inline CellRows rows_at(const CellFeatures& map, const LaneBuffer& moved, int row, int col) {
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(map.grid().cols) * map.lanes();
  return {.map = map.cell(row, col),
          .moved = moved.data() + row * stride + col * map.lanes(),
          .map_row_stride = map.row_stride(),
          .moved_row_stride = stride,
          .lanes = map.lanes()};
}

/// Central differences of kLanes channels along x and y, over two cells.
struct Slope {
  Lanes x;
  Lanes y;
};

/// The slope at a cell that has neighbours on all four sides.
inline Slope slope_at(const float* cell, std::ptrdiff_t row_stride, int lanes) {
  // Rows grow towards -x and columns towards -y.
  return {bevloc::lanes(cell - row_stride) - bevloc::lanes(cell + row_stride),
          bevloc::lanes(cell - lanes) - bevloc::lanes(cell + lanes)};
}

}  // namespace bevloc
