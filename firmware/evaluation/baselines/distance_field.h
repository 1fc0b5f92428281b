// How far a place is from the nearest line of a map, with its slope.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "firmware/evaluation/baselines/line_points.h"

namespace bevloc::evaluation {

/// A distance transform on kRasterGrid, read bilinearly between cells.
class DistanceField {
 public:
  struct Reading {
    double distance_m = 0.0;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< metres per metre of x and of y
  };

  explicit DistanceField(const LinePoints& lines);

  /// Without lines nothing can be read.
  bool is_empty() const { return distance_m_.empty(); }

  /// Outside the raster, as at its edge.
  Reading at(const Eigen::Vector2d& place_m) const;

 private:
  cv::Mat1f distance_m_;
};

}  // namespace bevloc::evaluation
