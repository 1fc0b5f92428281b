// Which line of a map is nearest to a place.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "firmware/evaluation/baselines/line_points.h"

namespace bevloc::evaluation {

/// For each cell of kRasterGrid the nearest of some points, which it borrows: they must outlive it.
class NearestLine {
 public:
  explicit NearestLine(const LinePoints& points);

  /// The nearest point to a place, by the centres of the cells of both; null without points and
  /// outside the raster.
  const LinePoint* to(const Eigen::Vector2d& place_m) const;

 private:
  cv::Mat1i label_;  ///< of each cell; empty without points
  std::vector<const LinePoint*> point_of_label_;
};

/// Cells that hold a point are 0, the others 255.
cv::Mat1b cells_without(const LinePoints& points);

/// The cell of a place, in whole numbers: x is the column, y the row. May lie outside the raster.
cv::Point cell_of(const Eigen::Vector2d& place_m);

}  // namespace bevloc::evaluation
