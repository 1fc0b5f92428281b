// Finds the nearest line point of a map for any position.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "evaluation/baselines/line_points.h"

namespace bevloc::evaluation {

/// Holds for each cell of kRasterGrid the nearest point. The points must outlive this object.
class NearestLine {
 public:
  explicit NearestLine(const LinePoints& points);

  /// The nearest point to a position; distances are measured between cell centres. Null if there
  /// are no points or the position is outside the raster.
  const LinePoint* to(const Eigen::Vector2d& position_m) const;

 private:
  cv::Mat1i label_;  ///< by cell; empty if there are no points
  std::vector<const LinePoint*> point_of_label_;
};

/// 0 in cells that contain a point, 255 in all others.
cv::Mat1b cells_without(const LinePoints& points);

/// The cell that contains a position: x is the column, y the row. It may lie outside the raster.
cv::Point cell_of(const Eigen::Vector2d& position_m);

}  // namespace bevloc::evaluation
