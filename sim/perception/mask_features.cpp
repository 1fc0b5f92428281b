#include "sim/perception/mask_features.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pipeline/map/rasterizer.h"

namespace bevloc::sim {
namespace {

constexpr double kCell_m = kRasterGrid.cell_m;

cv::Mat blurred(const cv::Mat& plane, double sigma_m) {
  const double sigma_cells = sigma_m / kCell_m;
  const int size = 2 * static_cast<int>(std::ceil(2.5 * sigma_cells)) + 1;
  cv::Mat result;
  cv::GaussianBlur(plane, result, {size, size}, sigma_cells, sigma_cells, cv::BORDER_REPLICATE);
  return result;
}

enum class Axis { kX, kY };  ///< kX is across rows, kY across columns

/// The derivative per metre. Callers do not use its sign.
cv::Mat slope(const cv::Mat& plane, Axis axis) {
  constexpr auto kTap = static_cast<float>(0.5 / kCell_m);
  cv::Mat result;
  if (axis == Axis::kX) {
    cv::filter2D(plane, result, CV_32F, cv::Matx31f(-kTap, 0.0F, kTap), {-1, -1}, 0.0,
                 cv::BORDER_REPLICATE);
  } else {
    cv::filter2D(plane, result, CV_32F, cv::Matx13f(-kTap, 0.0F, kTap), {-1, -1}, 0.0,
                 cv::BORDER_REPLICATE);
  }
  return result;
}

/// The distance in metres to the nearest cell above 0.5, or a large value if there is none.
cv::Mat distance_m(const cv::Mat& mask) {
  const cv::Mat away = mask <= 0.5;
  cv::Mat distance;
  cv::distanceTransform(away, distance, cv::DIST_L2, cv::DIST_MASK_5);
  return distance * kCell_m;
}

cv::Mat nearness(const cv::Mat& distance, double length_m) {
  cv::Mat result;
  cv::exp(distance * (-1.0 / length_m), result);
  return result;
}

/// Writes channel after channel into the features.
class ChannelWriter {
 public:
  ChannelWriter(const BevGrid& grid, std::span<float> features)
      : grid_(grid), features_(features) {}

  void put(const cv::Mat& plane) {
    cv::Mat1f target(grid_.rows, grid_.cols, features_.data());
    cv::resize(plane, target, target.size(), 0.0, 0.0, cv::INTER_AREA);
    features_ = features_.subspan(static_cast<size_t>(grid_.cells()));
  }

  void put_sixteen(const cv::Mat& plane) {
    const cv::Mat fine = blurred(plane, 0.3);
    put(fine);
    put(blurred(plane, 0.9));
    put(cv::abs(slope(fine, Axis::kX)));
    put(cv::abs(slope(fine, Axis::kY)));
    put(nearness(distance_m(plane), 1.0));
  }

  void put_sixty_four(const cv::Mat& plane) {
    put(plane);
    for (const double sigma_m : {0.15, 0.3, 0.6, 0.9, 1.5}) put(blurred(plane, sigma_m));
    for (const double sigma_m : {0.3, 0.9}) put_slopes(blurred(plane, sigma_m));
    put_ridges(blurred(plane, 0.45));
    const cv::Mat distance = distance_m(plane);
    for (const double length_m : {0.5, 1.0, 2.0}) put(nearness(distance, length_m));
  }

 private:
  /// Writes the slopes along x, y and the two diagonals.
  void put_slopes(const cv::Mat& plane) {
    const cv::Mat x = slope(plane, Axis::kX);
    const cv::Mat y = slope(plane, Axis::kY);
    put(cv::abs(x));
    put(cv::abs(y));
    put(cv::abs((x + y) * M_SQRT1_2));
    put(cv::abs((x - y) * M_SQRT1_2));
  }

  /// Writes the negative curvature (ridges) in four directions.
  void put_ridges(const cv::Mat& plane) {
    const cv::Mat x = slope(plane, Axis::kX);
    const cv::Mat xx = slope(x, Axis::kX);
    const cv::Mat xy = slope(x, Axis::kY);
    const cv::Mat yy = slope(slope(plane, Axis::kY), Axis::kY);
    const cv::Mat half_sum = 0.5 * (xx + yy);
    for (const cv::Mat& bend : {xx, yy, cv::Mat(half_sum + xy), cv::Mat(half_sum - xy)}) {
      put(cv::max(-bend, 0.0));
    }
  }

  BevGrid grid_;
  std::span<float> features_;  ///< the channels not yet written
};

}  // namespace

MaskFeatures::MaskFeatures(int channels, const BevGrid& grid) : channels_(channels), grid_(grid) {
  assert(channels == 3 || channels == 4 || channels == 16 || channels == 64);
  assert(grid == kFeatureGrid || grid == kRasterGrid);
}

void MaskFeatures::compute(std::span<const float> mask, std::span<float> features) {
  assert(mask.size() == kRasterSize);
  assert(features.size() == static_cast<size_t>(channels_) * grid_.cells());
  ChannelWriter writer(grid_, features);
  std::array<cv::Mat, kRasterChannels> planes;
  for (size_t k = 0; k < planes.size(); ++k) {
    planes[k] = cv::Mat1f(kRasterGrid.rows, kRasterGrid.cols,
                          const_cast<float*>(mask.data()) + k * kRasterGrid.cells());
    if (channels_ < 16) writer.put(planes[k]);
    if (channels_ == 16) writer.put_sixteen(planes[k]);
    if (channels_ == 64) writer.put_sixty_four(planes[k]);
  }
  if (channels_ == 3) return;
  const cv::Mat united = cv::max(cv::max(planes[0], planes[1]), planes[2]);
  writer.put(channels_ == 4 ? united : blurred(united, 0.3));
}

void MaskFeatures::compute(std::span<const uint8_t> raster, std::span<float> features) {
  mask_.resize(raster.size());
  std::transform(raster.begin(), raster.end(), mask_.begin(),
                 [](uint8_t value) { return static_cast<float>(value) * (1.0F / 255.0F); });
  compute(std::span<const float>(mask_), features);
}

}  // namespace bevloc::sim
