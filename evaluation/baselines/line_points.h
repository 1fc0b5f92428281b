// Finds the lines in a BEV image, as points on their centre lines.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc::evaluation {

/// A point on the centre line of a line, in metres in the vehicle frame. `normal` is perpendicular
/// to the line, with either sign.
struct LinePoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
};

using LinePoints = std::vector<LinePoint>;
/// The line points of each ElementClass.
using ClassLines = std::array<LinePoints, kRasterChannels>;

/// Finds the centre lines of the bright lines in `plane` (on kRasterGrid) with subcell accuracy: at
/// most one point per cell, and only in cells where `wanted` is not zero. C. Steger, "An Unbiased
/// Detector of Curvilinear Structures", 1998. The plane is blurred by `sigma_m`, which suits lines
/// up to 3.5 times as wide. The second derivative across the line must be below -`least_bend` per
/// square cell.
LinePoints line_points(const cv::Mat1f& plane, const cv::Mat1b& wanted, double sigma_m,
                       double least_bend);

/// The lines of each class in a mask (kRasterSize probabilities), where the probability exceeds
/// 0.5.
ClassLines lines_of_mask(std::span<const float> mask);
/// The lines of each class in a map's raster (kRasterSize bytes).
ClassLines lines_of_raster(std::span<const uint8_t> raster);

/// The points that stay inside the raster under every correction within the ranges.
LinePoints inside_for_all(const LinePoints& points, const HypothesisGrid& ranges);

}  // namespace bevloc::evaluation
