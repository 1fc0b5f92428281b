// A subset of the cells of a grid, evenly distributed.
#pragma once

#include "pipeline/bev_grid.h"

namespace bevloc {

/// In row r, the lattice has the columns skew * r mod step, + step, + 2 step, ... The lattices
/// below are square, so that they sample both axes equally densely.
struct CellLattice {
  int step = 1;
  int skew = 0;

  int first_col(int row) const { return row * skew % step; }
  /// Number of the lattice's cells in a row of `cols` columns.
  int cells(int row, int cols) const { return (cols - first_col(row) + step - 1) / step; }
  /// Number of the lattice's cells in the whole grid.
  int cells(const BevGrid& grid) const {
    int sum = 0;
    for (int row = 0; row < grid.rows; ++row) sum += cells(row, grid.cols);
    return sum;
  }
};

inline constexpr CellLattice kEveryCell{1, 0};
inline constexpr CellLattice kEverySecondCell{2, 1};  ///< one colour of a chessboard
inline constexpr CellLattice kEveryTenthCell{10, 3};  ///< nearest: one row, three columns away

}  // namespace bevloc
