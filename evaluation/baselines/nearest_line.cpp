#include "evaluation/baselines/nearest_line.h"

#include <opencv2/imgproc.hpp>

namespace bevloc::evaluation {
namespace {

const cv::Rect kRaster(0, 0, kRasterGrid.cols, kRasterGrid.rows);

}  // namespace

cv::Point cell_of(const Eigen::Vector2d& position_m) {
  return {cvRound(kRasterGrid.col_of_y(position_m.y())),
          cvRound(kRasterGrid.row_of_x(position_m.x()))};
}

cv::Mat1b cells_without(const LinePoints& points) {
  cv::Mat1b cells(kRasterGrid.rows, kRasterGrid.cols, uchar{255});
  for (const LinePoint& point : points) {
    const cv::Point cell = cell_of(point.position_m);
    if (kRaster.contains(cell)) cells(cell) = 0;
  }
  return cells;
}

NearestLine::NearestLine(const LinePoints& points) {
  if (points.empty()) return;
  cv::Mat1f distance;
  cv::distanceTransform(cells_without(points), distance, label_, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  point_of_label_.resize(points.size() + 1, nullptr);  // labels begin at 1
  for (const LinePoint& point : points) {
    const cv::Point cell = cell_of(point.position_m);
    if (kRaster.contains(cell)) point_of_label_[label_(cell)] = &point;
  }
}

const LinePoint* NearestLine::to(const Eigen::Vector2d& position_m) const {
  const cv::Point cell = cell_of(position_m);
  if (label_.empty() || !kRaster.contains(cell)) return nullptr;
  return point_of_label_[label_(cell)];
}

}  // namespace bevloc::evaluation
