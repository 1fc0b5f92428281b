#include "evaluation/baselines/ipm.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "evaluation/baselines/field_alignment.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {
namespace {

constexpr int cells_of(double length_m) {
  return static_cast<int>(length_m / kRasterGrid.cell_m + 0.5);
}

/// Wider structures are no lines.
constexpr int kWidestPaintCells = cells_of(0.75);
/// Width of the surrounding ground that a line is compared with.
constexpr int kGroundCells = cells_of(3.0);
/// A line must be brighter than the ground by this share of the ground's brightness, and by this
/// difference, so that the noise of a dark image is not taken for paint.
constexpr double kLeastContrast = 0.2;
constexpr double kLeastDifference = 6.0;
/// Cells this close to unseen ground are ignored, because the filter windows are cut there.
constexpr int kBorderCells = cells_of(0.45);

constexpr double kPaintSigma_m = 0.2;
/// The least bend (see line_points()) of a line whose contrast equals the threshold.
constexpr double kLeastBend = 0.05;

/// Mean brightness of the visible ground around each cell.
cv::Mat mean_around(const GroundImage& ground) {
  const cv::Size window(kGroundCells, kGroundCells);
  cv::Mat1f sum;
  cv::Mat1f count;
  cv::boxFilter(ground.brightness, sum, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(ground.seen, count, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  return 255.0 * sum / cv::max(count, 1.0F);
}

}  // namespace

LinePoints paint_lines(const GroundImage& ground) {
  const cv::Mat widest =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {kWidestPaintCells, kWidestPaintCells});
  cv::Mat1f top_hat;
  cv::morphologyEx(ground.brightness, top_hat, cv::MORPH_TOPHAT, widest);
  const cv::Mat threshold = cv::max(kLeastContrast * mean_around(ground), kLeastDifference);
  const cv::Mat contrast = top_hat / threshold;
  cv::Mat inside;
  const cv::Mat border = cv::Mat::ones(2 * kBorderCells + 1, 2 * kBorderCells + 1, CV_8U);
  cv::erode(ground.seen, inside, border);
  const cv::Mat wanted = (contrast > 1.0) & inside;
  return line_points(contrast, wanted, kPaintSigma_m, kLeastBend);
}

Se2 InversePerspectiveMapping::correct(const BaselineInput& input) {
  const ClassLines map = lines_of_raster(input.raster);
  LinePoints painted = map[static_cast<size_t>(ElementClass::kLaneDivider)];
  const LinePoints& crossings = map[static_cast<size_t>(ElementClass::kPedestrianCrossing)];
  painted.insert(painted.end(), crossings.begin(), crossings.end());
  const LinePoints seen = paint_lines(GroundView(input.rig).project(input.images, input.cameras));
  const std::array<PointsOnField, 1> pair{
      PointsOnField{inside_for_all(seen, ranges_), DistanceField(painted)}};
  return align(pair, ranges_);
}

}  // namespace bevloc::evaluation
