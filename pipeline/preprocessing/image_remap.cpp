#include "pipeline/preprocessing/image_remap.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

constexpr int kPixels = kNetworkWidthPx * kNetworkHeightPx;
constexpr int kWeightBits = 8;
constexpr int kWeightSum = 1 << kWeightBits;
constexpr int kMaxTaps = 32;

/// Weights of the pixels under a box of width `box` around `centre`, in a line of `length` pixels.
/// Pixels beyond the line's end are taken to be the last one. Returns the first pixel.
int box_weights(double centre, double box, int length, std::span<uint16_t> weights) {
  const int taps = static_cast<int>(weights.size());
  const int begin = static_cast<int>(std::floor(centre - 0.5 * box + 0.5));
  const int first = std::clamp(begin, 0, length - taps);
  std::array<double, kMaxTaps> exact{};
  for (int pixel = begin; pixel < begin + taps; ++pixel) {
    const double overlap =
        std::min(pixel + 0.5, centre + 0.5 * box) - std::max(pixel - 0.5, centre - 0.5 * box);
    exact[std::clamp(pixel, 0, length - 1) - first] += std::max(0.0, overlap) / box;
  }
  int left_over = kWeightSum;
  for (int i = 0; i < taps; ++i) {
    weights[i] = static_cast<uint16_t>(std::lround(exact[i] * kWeightSum));
    left_over -= weights[i];
  }
  uint16_t& largest = *std::max_element(weights.begin(), weights.end());
  largest = static_cast<uint16_t>(largest + left_over);
  return first;
}

RemapTable make_table(const CameraModel& camera) {
  const Intrinsics& real = camera.intrinsics;
  const Intrinsics network = network_camera(camera).intrinsics;
  const double box = std::max(1.0, static_cast<double>(real.width_px) / kNetworkWidthPx);

  RemapTable table;
  table.taps = static_cast<int>(std::ceil(box)) + 1;
  assert(table.taps <= kMaxTaps && table.taps <= std::min(real.width_px, real.height_px));
  table.first_col.resize(kPixels);
  table.first_row.resize(kPixels);
  table.weights.resize(2 * static_cast<size_t>(table.taps) * kPixels);
  for (int i = 0; i < kPixels; ++i) {
    const Eigen::Vector2d pixel(i % kNetworkWidthPx, i / kNetworkWidthPx);
    const auto source = real.project(network.ray(pixel));
    const bool inside = source && source->x() >= -0.5 && source->x() <= real.width_px - 0.5 &&
                        source->y() >= -0.5 && source->y() <= real.height_px - 0.5;
    if (!inside) continue;
    const std::span weights =
        std::span(table.weights).subspan(2 * static_cast<size_t>(table.taps) * i);
    table.first_col[i] = static_cast<uint16_t>(
        box_weights(source->x(), box, real.width_px, weights.first(table.taps)));
    table.first_row[i] = static_cast<uint16_t>(
        box_weights(source->y(), box, real.height_px, weights.subspan(table.taps, table.taps)));
  }
  return table;
}

/// The rows of a box are summed first (contiguous bytes: this is what vectorises), then the
/// columns.
[[gnu::always_inline]] inline void remap_pixels(const RgbView& image, const RemapTable& table,
                                                int taps, int8_t* planes) {
  const uint16_t* weights = table.weights.data();
  for (int i = 0; i < kPixels; ++i, weights += 2 * taps) {
    const uint8_t* box =
        image.data + table.first_row[i] * image.stride_bytes + 3 * table.first_col[i];
    uint16_t columns[3 * kMaxTaps] = {};
    for (int row = 0; row < taps; ++row, box += image.stride_bytes) {
      const uint16_t weight = weights[taps + row];
      for (int j = 0; j < 3 * taps; ++j) {
        columns[j] = static_cast<uint16_t>(columns[j] + weight * box[j]);
      }
    }
    for (int channel = 0; channel < 3; ++channel) {
      uint32_t sum = 1U << (2 * kWeightBits - 1);
      for (int col = 0; col < taps; ++col) sum += columns[3 * col + channel] * weights[col];
      planes[channel * kPixels + i] = static_cast<int8_t>((sum >> (2 * kWeightBits)) - 128);
    }
  }
}

/// The tap counts of usual frames (640 to 1280 pixels wide) are compiled as constants.
BEVLOC_TARGET_CLONES
void remap(const RgbView& image, const RemapTable& table, int8_t* planes) {
  switch (table.taps) {
    case 2:
      return remap_pixels(image, table, 2, planes);
    case 3:
      return remap_pixels(image, table, 3, planes);
    case 4:
      return remap_pixels(image, table, 4, planes);
    case 5:
      return remap_pixels(image, table, 5, planes);
    default:
      return remap_pixels(image, table, table.taps, planes);
  }
}

}  // namespace

ImagePreprocessor::ImagePreprocessor(const CameraModel& camera)
    : width_px_(camera.intrinsics.width_px),
      height_px_(camera.intrinsics.height_px),
      table_(make_table(camera)) {}

Status ImagePreprocessor::run(const RgbView& image, std::span<int8_t> planes) const {
  assert(planes.size() == kNetworkImageSize);
  if (image.width != width_px_ || image.height != height_px_) {
    return fail("camera frame is {}x{} pixels, the calibration wants {}x{}", image.width,
                image.height, width_px_, height_px_);
  }
  remap(image, table_, planes.data());
  return {};
}

}  // namespace bevloc
