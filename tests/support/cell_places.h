// Where the cells of a grid lie.
#pragma once

#include <Eigen/Core>

#include "pipeline/bev_grid.h"

namespace bevloc::test {

/// The centre of a cell in the vehicle frame. Cells are counted row by row.
inline Eigen::Vector2d place_of(const BevGrid& grid, int cell) {
  return {grid.x_of_row(cell / grid.cols), grid.y_of_col(cell % grid.cols)};
}

}  // namespace bevloc::test
