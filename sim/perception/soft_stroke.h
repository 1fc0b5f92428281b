// Draws soft lines of varying width, strength and blur into a mask.
#pragma once

#include <span>

#include <Eigen/Core>

namespace bevloc::sim {

/// A point of a stroke, in the vehicle frame.
struct StrokePoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double half_width_m = 0.0;
  double strength = 0.0;    ///< value on the line, 0 to 1
  double softness_m = 0.0;  ///< above 0: half of the way over which the value falls to 0
};

/// Raises the cells of one class (kRasterGrid, row by row) to the stroke's value, which falls
/// linearly from `strength` to 0 over 2 * `softness_m` around the distance `half_width_m`. Ends and
/// joints are round. With a softness of half a cell it is what MapRasterizer draws.
void draw_stroke(std::span<const StrokePoint> stroke, std::span<float> cells);

}  // namespace bevloc::sim
