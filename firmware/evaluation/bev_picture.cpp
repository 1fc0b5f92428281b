#include "firmware/evaluation/bev_picture.h"

#include <algorithm>
#include <cassert>

#include "firmware/drawing.h"
#include "pipeline/solver/standardise.h"
#include "sim/perception/mask_features.h"

namespace bevloc::evaluation {
namespace {

const cv::Scalar kShade(200, 200, 200);

/// Colours a pixel as far as `share` says.
void tint(cv::Vec3b& pixel, const cv::Scalar& color, double share) {
  for (int c = 0; c < 3; ++c) {
    pixel[c] = cv::saturate_cast<uint8_t>(pixel[c] + share * (color[c] - pixel[c]));
  }
}

template <typename Value>
std::vector<float> compute_features(std::span<const Value> mask, int channels) {
  std::vector<float> features(static_cast<size_t>(channels) * kFeatureGrid.cells());
  sim::MaskFeatures(channels, kFeatureGrid).compute(mask, features);
  return features;
}

}  // namespace

cv::Mat3b bev_picture(std::span<const float> planes, const BevGrid& grid) {
  cv::Mat3b picture(grid.rows, grid.cols, cv::Vec3b(255, 255, 255));
  for (int k = 0; k < kRasterChannels; ++k) {
    const cv::Scalar color = class_color(static_cast<ElementClass>(k));
    for (int cell = 0; cell < grid.cells(); ++cell) {
      const double value = planes[static_cast<size_t>(k) * grid.cells() + cell];
      tint(picture(cell), color, std::clamp(value, 0.0, 1.0));
    }
  }
  return picture;
}

cv::Mat3b bev_picture(std::span<const uint8_t> raster) {
  std::vector<float> planes(raster.size());
  std::ranges::transform(raster, planes.begin(),
                         [](uint8_t value) { return static_cast<float>(value) / 255.0F; });
  return bev_picture(planes, kRasterGrid);
}

void shade(std::span<const uint8_t> raster, cv::Mat3b& picture) {
  const int cells = kRasterGrid.cells();
  for (int cell = 0; cell < cells; ++cell) {
    uint8_t drawn = 0;
    for (int k = 0; k < kRasterChannels; ++k) drawn = std::max(drawn, raster[k * cells + cell]);
    cv::Vec3b under(255, 255, 255);
    tint(under, kShade, drawn / 255.0);
    cv::Vec3b& pixel = picture(cell);
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uint8_t>(pixel[c] * under[c] / 255);
  }
}

std::vector<float> features_of(std::span<const float> mask, int channels) {
  return compute_features(mask, channels);
}

std::vector<float> features_of(std::span<const uint8_t> raster, int channels) {
  return compute_features(raster, channels);
}

CellFeatures standardised_cells(std::span<const float> features, int channels,
                                const HypothesisGrid& hypotheses) {
  CellFeatures cells(kFeatureGrid, channels, hypotheses);
  cells.assign(features);
  [[maybe_unused]] const bool matchable = standardise(cells);
  assert(matchable);
  return cells;
}

}  // namespace bevloc::evaluation
