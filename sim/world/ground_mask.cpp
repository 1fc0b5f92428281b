#include "sim/world/ground_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace bevloc::sim {
namespace {

constexpr double kMargin_m = 40.0;
constexpr double kMaskCell_m = 1.0;
constexpr int kCoarsening = 2;  ///< cells of the raster per cell of the distances
constexpr int kSubpixelBits = 4;

}  // namespace

GroundMask::GroundMask(const std::vector<const Ring*>& paved) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high = -low;
  for (const Ring* ring : paved) {
    for (const Eigen::Vector2d& point : *ring) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  if (low.x() > high.x()) low = high = Eigen::Vector2d::Zero();
  min_corner_ = low - Eigen::Vector2d::Constant(kMargin_m);
  const Eigen::Vector2d size =
      (high - low) / kMaskCell_m + Eigen::Vector2d::Constant(2.0 * kMargin_m);
  occupied_ = cv::Mat(static_cast<int>(std::ceil(size.y())), static_cast<int>(std::ceil(size.x())),
                      CV_8U, cv::Scalar(0));
  for (const Ring* ring : paved) occupy(*ring);
  cv::Mat unpaved;
  cv::resize(occupied_, unpaved, {}, 1.0 / kCoarsening, 1.0 / kCoarsening, cv::INTER_AREA);
  cv::distanceTransform(unpaved == 0, distance_, cv::DIST_L2, 3);
}

Eigen::Vector2d GroundMask::max_corner() const {
  return min_corner_ + kMaskCell_m * Eigen::Vector2d(occupied_.cols, occupied_.rows);
}

bool GroundMask::cell_at(const Eigen::Vector2d& point, cv::Point& cell) const {
  const Eigen::Vector2d local = (point - min_corner_) / kMaskCell_m;
  cell = {static_cast<int>(std::floor(local.x())), static_cast<int>(std::floor(local.y()))};
  return cell.x >= 0 && cell.y >= 0 && cell.x < occupied_.cols && cell.y < occupied_.rows;
}

double GroundMask::distance_to_paved_m(const Eigen::Vector2d& point) const {
  cv::Point cell;
  if (!cell_at(point, cell)) return 0.0;
  const cv::Point coarse(std::min(cell.x / kCoarsening, distance_.cols - 1),
                         std::min(cell.y / kCoarsening, distance_.rows - 1));
  return kMaskCell_m * kCoarsening * static_cast<double>(distance_.at<float>(coarse));
}

bool GroundMask::is_free(const Ring& ring) const {
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d edge = ring[(i + 1) % ring.size()] - a;
    const int pieces = std::max(1, static_cast<int>(std::ceil(edge.norm() / kMaskCell_m)));
    for (int k = 0; k < pieces; ++k) {
      cv::Point cell;
      const Eigen::Vector2d point = a + edge * k / pieces;
      if (!cell_at(point, cell) || occupied_.at<uint8_t>(cell) != 0) return false;
    }
  }
  return true;
}

void GroundMask::occupy(const Ring& ring) {
  cv::fillPoly(occupied_, std::vector<std::vector<cv::Point>>{fixed_point(ring)}, cv::Scalar(255),
               cv::LINE_8, kSubpixelBits);
}

void GroundMask::occupy_line(const Polyline& line) {
  cv::polylines(occupied_, std::vector<std::vector<cv::Point>>{fixed_point(line)}, false,
                cv::Scalar(255), 1, cv::LINE_8, kSubpixelBits);
}

/// Converts to the fixed-point cell coordinates of OpenCV's drawing functions.
std::vector<cv::Point> GroundMask::fixed_point(const Polyline& line) const {
  std::vector<cv::Point> points;
  points.reserve(line.size());
  for (const Eigen::Vector2d& point : line) {
    const Eigen::Vector2d local =
        ((point - min_corner_) / kMaskCell_m - Eigen::Vector2d::Constant(0.5)) *
        (1 << kSubpixelBits);
    points.emplace_back(static_cast<int>(std::lround(local.x())),
                        static_cast<int>(std::lround(local.y())));
  }
  return points;
}

}  // namespace bevloc::sim
