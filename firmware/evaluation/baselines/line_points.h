// The middles of the lines in a picture of the ground, as points.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/solver.h"

namespace bevloc::evaluation {

/// A point in the middle of a line, metres in the frame of its picture; `normal` points across the
/// line, either way.
struct LinePoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
};

using LinePoints = std::vector<LinePoint>;
/// By ElementClass.
using ClassLines = std::array<LinePoints, kRasterChannels>;

/// Where a bright line of `plane` (on kRasterGrid) has its middle, to a fraction of a cell, at most
/// one point a cell; only where `wanted` is not zero (C. Steger, "An Unbiased Detector of
/// Curvilinear Structures", 1998). `sigma_m` suits lines of up to 3.5 times that width, and
/// `least_bend` is how strongly the blurred plane must bend down across, per square cell.
LinePoints line_points(const cv::Mat1f& plane, const cv::Mat1b& wanted, double sigma_m,
                       double least_bend);

/// Those of each class where it is more likely than not, kRasterSize probabilities.
ClassLines lines_of_mask(std::span<const float> mask);
/// Those of a map's raster, kRasterSize bytes.
ClassLines lines_of_raster(std::span<const uint8_t> raster);

/// The points that stay inside the raster under every correction within the ranges.
LinePoints that_stay_inside(const LinePoints& points, const HypothesisGrid& ranges);

}  // namespace bevloc::evaluation
