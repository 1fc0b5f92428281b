#include "evaluation/baselines/distance_field.h"

#include <algorithm>
#include <cassert>

#include <opencv2/imgproc.hpp>

#include "evaluation/baselines/nearest_line.h"

namespace bevloc::evaluation {

DistanceField::DistanceField(const LinePoints& lines) {
  if (lines.empty()) return;
  cv::distanceTransform(cells_without(lines), distance_m_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  distance_m_ *= kRasterGrid.cell_m;
}

DistanceField::Reading DistanceField::at(const Eigen::Vector2d& point_m) const {
  assert(!is_empty());
  const double row = std::clamp(kRasterGrid.row_of_x(point_m.x()), 0.0, kRasterGrid.rows - 1.001);
  const double col = std::clamp(kRasterGrid.col_of_y(point_m.y()), 0.0, kRasterGrid.cols - 1.001);
  const int top = static_cast<int>(row);
  const int left = static_cast<int>(col);
  const double down = row - top;
  const double right = col - left;
  const double a = distance_m_(top, left);
  const double b = distance_m_(top, left + 1);
  const double c = distance_m_(top + 1, left);
  const double d = distance_m_(top + 1, left + 1);
  const double per_row = (1.0 - right) * (c - a) + right * (d - b);
  const double per_col = (1.0 - down) * (b - a) + down * (d - c);
  return {(1.0 - down) * ((1.0 - right) * a + right * b) + down * ((1.0 - right) * c + right * d),
          {-per_row / kRasterGrid.cell_m, -per_col / kRasterGrid.cell_m}};
}

}  // namespace bevloc::evaluation
