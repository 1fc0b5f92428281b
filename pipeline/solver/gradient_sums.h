// How the features of both sides change with the pose, summed over cells.
#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace bevloc {

/// Neighbouring cells of a row of both sides; both have neighbours all around.
struct GradientRow {
  const float* map;
  const float* moved;
  std::ptrdiff_t map_row_stride;
  std::ptrdiff_t moved_row_stride;
  int lanes;
  int cells;
  double cell_m;
  double x_m;        ///< of the row, from the point that a turn is about
  double first_y_m;  ///< of the first cell, likewise
};

/// Over a row's cells and channels, with J the gradients by (x m, y m, yaw rad) of the map's
/// features (J_M) and of the moved ones (J_B), from differences over two cells.
struct GradientSums {
  Eigen::Matrix3d curvature;  ///< J_M^T J_B
  Eigen::Vector3d slope;      ///< J_M^T (map - moved)
};
GradientSums sum_gradients(const GradientRow& row);

}  // namespace bevloc
