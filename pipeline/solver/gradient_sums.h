// Sums of the gradients of both sides' features by the pose.
#pragma once

#include <Eigen/Core>

#include "pipeline/solver/cell_rows.h"

namespace bevloc {

/// Neighbouring cells of one row of both sides. Every cell must have neighbours on all four sides.
struct GradientRow {
  CellRows rows;
  int cells;
  double cell_m;
  double x_m;        ///< x of the row, relative to the centre of rotation
  double first_y_m;  ///< y of the first cell, likewise
};

/// Sums over the cells of a row and all channels. J_M and J_B are the gradients of the map features
/// and of the moved BEV features by (x m, y m, yaw rad), from central differences.
struct GradientSums {
  Eigen::Matrix3d curvature;  ///< J_M^T J_B
  Eigen::Vector3d slope;      ///< J_M^T (map - moved)
};
GradientSums sum_gradients(const GradientRow& row);

}  // namespace bevloc
