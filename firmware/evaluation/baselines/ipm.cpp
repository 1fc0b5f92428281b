#include "firmware/evaluation/baselines/ipm.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "firmware/evaluation/baselines/field_alignment.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {
namespace {

constexpr int cells_of(double length_m) {
  return static_cast<int>(length_m / kRasterGrid.cell_m + 0.5);
}

/// What is wider than this is no line.
constexpr int kWidestPaintCells = cells_of(0.75);
/// The ground around a line, whose brightness it must exceed.
constexpr int kGroundCells = cells_of(3.0);
/// By this share of it, and by this much in any case: noise of a dark picture is no paint.
constexpr double kLeastContrast = 0.2;
constexpr double kLeastDifference = 6.0;
/// At the border of what is seen the opening's and the mean's windows are cut.
constexpr int kBorderCells = cells_of(0.45);

constexpr double kPaintSigma_m = 0.2;
/// Of a line that is as much brighter than the ground as the threshold wants it to be.
constexpr double kLeastBend = 0.05;

/// Mean brightness of the ground that is seen around each cell.
cv::Mat mean_around(const GroundPicture& picture) {
  const cv::Size window(kGroundCells, kGroundCells);
  cv::Mat1f sum;
  cv::Mat1f count;
  cv::boxFilter(picture.brightness, sum, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(picture.seen, count, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  return 255.0 * sum / cv::max(count, 1.0F);
}

}  // namespace

LinePoints paint_lines(const GroundPicture& picture) {
  const cv::Mat widest =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {kWidestPaintCells, kWidestPaintCells});
  cv::Mat1f top_hat;
  cv::morphologyEx(picture.brightness, top_hat, cv::MORPH_TOPHAT, widest);
  const cv::Mat threshold = cv::max(kLeastContrast * mean_around(picture), kLeastDifference);
  const cv::Mat contrast = top_hat / threshold;
  cv::Mat inside;
  const cv::Mat border = cv::Mat::ones(2 * kBorderCells + 1, 2 * kBorderCells + 1, CV_8U);
  cv::erode(picture.seen, inside, border);
  const cv::Mat wanted = (contrast > 1.0) & inside;
  return line_points(contrast, wanted, kPaintSigma_m, kLeastBend);
}

Se2 InversePerspectiveMapping::correct(const BaselineInput& input) {
  const ClassLines map = lines_of_raster(input.raster);
  LinePoints painted = map[static_cast<size_t>(ElementClass::kLaneDivider)];
  const LinePoints& crossings = map[static_cast<size_t>(ElementClass::kPedestrianCrossing)];
  painted.insert(painted.end(), crossings.begin(), crossings.end());
  const LinePoints seen = paint_lines(ground_view_.look(input.images, input.cameras));
  const std::array<PointsOnField, 1> pair{
      PointsOnField{that_stay_inside(seen, ranges_), DistanceField(painted)}};
  return align(pair, ranges_);
}

}  // namespace bevloc::evaluation
