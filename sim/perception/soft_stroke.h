// Draws blurred lines of varying width and strength into a mask.
#pragma once

#include <span>

#include <Eigen/Core>

namespace bevloc::sim {

/// A point of a stroke, in the vehicle frame.
struct StrokePoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double half_width_m = 0.0;
  double strength = 0.0;    ///< value on the line, 0 to 1
  double softness_m = 0.0;  ///< half of the width of the edge, where the value falls to 0; > 0
};

/// Raises the cells of one class (kRasterGrid, row by row) to the value of the stroke. The value
/// falls linearly from `strength` to 0 between the distances half_width_m - softness_m and
/// half_width_m + softness_m. Ends and joints are round. With a softness of half a cell the result
/// equals that of MapRasterizer.
void draw_stroke(std::span<const StrokePoint> stroke, std::span<float> cells);

}  // namespace bevloc::sim
