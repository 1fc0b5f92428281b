#include "evaluation/baselines/line_points.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "pipeline/map/rasterizer.h"

namespace bevloc::evaluation {
namespace {

/// Suits lines as MapRasterizer draws them: kRasterLineWidthCells wide, with value 1.
constexpr double kMaskSigma_m = 2.0 * kRasterGrid.cell_m;
constexpr double kMaskLeastBend = 0.02;

/// Cells this close to the edge are ignored, because the course of a line beyond the edge is
/// unknown.
constexpr int kEdgeCells = 2;

/// The centre line lies in a cell if it is this close to the cell's centre along both axes. The
/// value is slightly more than 0.5, so that rounding loses no point between two cells.
constexpr double kInCell = 0.55;

/// First and second derivatives of a blurred plane, per cell; u counts columns, v rows.
struct Derivatives {
  cv::Mat1f u, v, uu, uv, vv;
};

Derivatives derivatives_of(const cv::Mat1f& plane, double sigma_cells) {
  cv::Mat1f blurred;
  cv::GaussianBlur(plane, blurred, {}, sigma_cells, sigma_cells, cv::BORDER_REPLICATE);
  Derivatives d;
  const auto derive = [&blurred](cv::Mat1f& target, int order_u, int order_v, double scale) {
    cv::Sobel(blurred, target, CV_32F, order_u, order_v, 3, scale, 0.0, cv::BORDER_REPLICATE);
  };
  derive(d.u, 1, 0, 1.0 / 8.0);
  derive(d.v, 0, 1, 1.0 / 8.0);
  derive(d.uu, 2, 0, 1.0 / 4.0);
  derive(d.uv, 1, 1, 1.0 / 4.0);
  derive(d.vv, 0, 2, 1.0 / 4.0);
  return d;
}

/// The point of a centre line that runs through the cell, if there is one.
std::optional<LinePoint> line_in_cell(const Derivatives& d, int row, int col, double least_bend) {
  const double uu = d.uu(row, col);
  const double uv = d.uv(row, col);
  const double vv = d.vv(row, col);
  const double mean = 0.5 * (uu + vv);
  const double bend = mean - std::hypot(0.5 * (uu - vv), uv);  // the lower eigenvalue
  if (bend > -least_bend) return std::nullopt;
  // The eigenvector, computed from the row of the matrix with the larger entries.
  Eigen::Vector2d across = std::abs(uu - bend) > std::abs(vv - bend)
                               ? Eigen::Vector2d(-uv, uu - bend)
                               : Eigen::Vector2d(vv - bend, -uv);
  if (across.isZero()) across = Eigen::Vector2d::UnitX();
  across.normalize();
  const Eigen::Vector2d offset =
      -(across.x() * d.u(row, col) + across.y() * d.v(row, col)) / bend * across;
  if (offset.cwiseAbs().maxCoeff() > kInCell) return std::nullopt;
  return LinePoint{{kRasterGrid.x_of_row(row + offset.y()), kRasterGrid.y_of_col(col + offset.x())},
                   {across.y(), across.x()}};
}

}  // namespace

LinePoints line_points(const cv::Mat1f& plane, const cv::Mat1b& wanted, double sigma_m,
                       double least_bend) {
  assert(plane.rows == kRasterGrid.rows && plane.cols == kRasterGrid.cols);
  assert(wanted.size() == plane.size());
  const Derivatives derivatives = derivatives_of(plane, sigma_m / kRasterGrid.cell_m);
  LinePoints points;
  for (int row = kEdgeCells; row < plane.rows - kEdgeCells; ++row) {
    for (int col = kEdgeCells; col < plane.cols - kEdgeCells; ++col) {
      if (wanted(row, col) == 0) continue;
      const auto point = line_in_cell(derivatives, row, col, least_bend);
      if (point) points.push_back(*point);
    }
  }
  return points;
}

ClassLines lines_of_mask(std::span<const float> mask) {
  assert(mask.size() == kRasterSize);
  ClassLines lines;
  for (size_t k = 0; k < lines.size(); ++k) {
    const cv::Mat1f plane(kRasterGrid.rows, kRasterGrid.cols,
                          const_cast<float*>(mask.data()) + k * kRasterGrid.cells());
    const cv::Mat likely = plane > 0.5;
    lines[k] = line_points(plane, likely, kMaskSigma_m, kMaskLeastBend);
  }
  return lines;
}

ClassLines lines_of_raster(std::span<const uint8_t> raster) {
  std::vector<float> mask(raster.size());
  std::ranges::transform(raster, mask.begin(),
                         [](uint8_t value) { return static_cast<float>(value) / 255.0F; });
  return lines_of_mask(mask);
}

LinePoints inside_for_all(const LinePoints& points, const HypothesisGrid& ranges) {
  const double turn = std::sin(ranges.yaw_rad.range);
  const double x_limit_m =
      kRasterGrid.x_range_m() - ranges.x_m.range - turn * kRasterGrid.y_range_m();
  const double y_limit_m =
      kRasterGrid.y_range_m() - ranges.y_m.range - turn * kRasterGrid.x_range_m();
  LinePoints inside;
  std::ranges::copy_if(points, std::back_inserter(inside), [&](const LinePoint& point) {
    return std::abs(point.position_m.x()) < x_limit_m && std::abs(point.position_m.y()) < y_limit_m;
  });
  return inside;
}

}  // namespace bevloc::evaluation
