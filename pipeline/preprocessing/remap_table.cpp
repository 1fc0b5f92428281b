#include "pipeline/preprocessing/remap_table.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

#include "pipeline/calibration/rig_check.h"

namespace bevloc {
namespace {

// A box is at most as wide as the ratio of the widths of both images, and it may touch one pixel
// more.
static_assert(kMostImageSide_px <= (RemapTable::kMaxTaps - 1) * kNetworkWidthPx);

/// Computes the weights of the pixels under a box of width `box` around `centre`, in a line of
/// `length` pixels. Beyond its ends the line repeats its end pixels. Returns the first pixel.
int box_weights(double centre, double box, int length, std::span<uint16_t> weights) {
  const int taps = static_cast<int>(weights.size());
  const int begin = static_cast<int>(std::floor(centre - 0.5 * box + 0.5));
  const int first = std::clamp(begin, 0, length - taps);
  std::array<double, RemapTable::kMaxTaps> exact{};
  for (int pixel = begin; pixel < begin + taps; ++pixel) {
    const double overlap =
        std::min(pixel + 0.5, centre + 0.5 * box) - std::max(pixel - 0.5, centre - 0.5 * box);
    exact[std::clamp(pixel, 0, length - 1) - first] += std::max(0.0, overlap) / box;
  }
  int remainder = RemapTable::kWeightSum;
  for (int i = 0; i < taps; ++i) {
    weights[i] = static_cast<uint16_t>(std::lround(exact[i] * RemapTable::kWeightSum));
    remainder -= weights[i];
  }
  uint16_t& largest = *std::max_element(weights.begin(), weights.end());
  largest = static_cast<uint16_t>(largest + remainder);
  return first;
}

}  // namespace

RemapTable make_remap_table(const CameraModel& camera) {
  const Intrinsics& real = camera.intrinsics;
  const Intrinsics network = network_camera(camera).intrinsics;
  const double box = std::max(1.0, real_pixels_per_network_pixel(real));

  RemapTable table;
  table.taps = static_cast<int>(std::ceil(box)) + 1;
  assert(table.taps <= RemapTable::kMaxTaps &&
         table.taps <= std::min(real.width_px, real.height_px));
  table.first_col.resize(kNetworkPixels);
  table.first_row.resize(kNetworkPixels);
  table.weights.resize(2 * static_cast<size_t>(table.taps) * kNetworkPixels);
  for (int i = 0; i < kNetworkPixels; ++i) {
    const Eigen::Vector2d pixel(i % kNetworkWidthPx, i / kNetworkWidthPx);
    const auto source = shown_place(camera, network, pixel);
    if (!source) continue;
    const std::span weights =
        std::span(table.weights).subspan(2 * static_cast<size_t>(table.taps) * i);
    table.first_col[i] = static_cast<uint16_t>(
        box_weights(source->x(), box, real.width_px, weights.first(table.taps)));
    table.first_row[i] = static_cast<uint16_t>(
        box_weights(source->y(), box, real.height_px, weights.subspan(table.taps, table.taps)));
  }
  table.blocks = make_remap_blocks(table, real.width_px, real.height_px);
  return table;
}

}  // namespace bevloc
