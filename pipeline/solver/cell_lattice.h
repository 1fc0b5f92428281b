// Some of a grid's cells, evenly spread.
#pragma once

#include "pipeline/bev_grid.h"

namespace bevloc {

/// Of row r the columns skew r mod step, and every step-th from there on. The lattices below are
/// square, so that they miss as little along one axis as along the other.
struct CellLattice {
  int step = 1;
  int skew = 0;

  int first_col(int row) const { return row * skew % step; }
  /// Of a row of `cols` columns.
  int cells(int row, int cols) const { return (cols - first_col(row) + step - 1) / step; }
  int cells(const BevGrid& grid) const {
    int sum = 0;
    for (int row = 0; row < grid.rows; ++row) sum += cells(row, grid.cols);
    return sum;
  }
};

inline constexpr CellLattice kEveryCell{1, 0};
inline constexpr CellLattice kEverySecondCell{2, 1};  ///< one colour of a chessboard
inline constexpr CellLattice kEveryTenthCell{10, 3};  ///< the nearest: a row and three columns away

}  // namespace bevloc
