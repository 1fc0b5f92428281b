// The distance from any point to the nearest line of a map, with its gradient.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "evaluation/baselines/line_points.h"

namespace bevloc::evaluation {

/// A distance transform on kRasterGrid, interpolated bilinearly between cells.
class DistanceField {
 public:
  struct Reading {
    double distance_m = 0.0;
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  ///< d distance / d (x, y)
  };

  explicit DistanceField(const LinePoints& lines);

  /// True if there are no lines. at() must not be called then.
  bool is_empty() const { return distance_m_.empty(); }

  /// Distance and gradient at a point. A point outside the raster gets the values of the nearest
  /// edge.
  Reading at(const Eigen::Vector2d& point_m) const;

 private:
  cv::Mat1f distance_m_;
};

}  // namespace bevloc::evaluation
