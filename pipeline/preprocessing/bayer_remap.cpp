#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/preprocessing/format_remap.h"

namespace bevloc {
namespace {

/// Interpolation between samples of one colour, two pixels apart, widens a box by one pixel on each
/// side.
constexpr int kMaxSamples = RemapTable::kMaxTaps + 2;
/// Weights of one lattice along one axis sum to 2^kLatticeBits = 2 * RemapTable::kWeightSum.
constexpr int kLatticeBits = RemapTable::kWeightBits + 1;

/// Weights along one axis of the samples from which the pixels of a box are interpolated. A lattice
/// holds the samples of one parity. A pixel on the lattice takes its own sample, a pixel between
/// takes half of each neighbour. The weights of each parity sum to 2 * kWeightSum.
struct LatticeWeights {
  int first;
  uint16_t weights[kMaxSamples];

  [[gnu::always_inline]] LatticeWeights(int first_pixel, const uint16_t* box, int taps, int length)
      : first(std::clamp(first_pixel - 1, 0, length - taps - 2)) {
    for (int i = 0; i < taps + 2; ++i) weights[i] = 0;
    const auto add = [this](int pixel, int weight) __attribute__((always_inline)) {
      weights[pixel - first] = static_cast<uint16_t>(weights[pixel - first] + weight);
    };
    for (int i = 0; i < taps; ++i) {
      const int pixel = first_pixel + i;
      add(pixel, 2 * box[i]);
      add(pixel == 0 ? 1 : pixel - 1, box[i]);
      add(pixel == length - 1 ? length - 2 : pixel + 1, box[i]);
    }
  }
};

[[gnu::always_inline]] inline void remap_pixels(const ImageView& image, const RemapTable& table,
                                                PixelRange range, int red_row, int red_col,
                                                int taps, int8_t* planes) {
  const ImagePlane& plane = image.planes[0];
  const uint16_t* weights = table.weights.data() + 2 * taps * range.begin;
  const int samples = taps + 2;
  for (int i = range.begin; i < range.end; ++i, weights += 2 * taps) {
    const LatticeWeights cols(table.first_col[i], weights, taps, image.width);
    const LatticeWeights rows(table.first_row[i], weights + taps, taps, image.height);
    const uint8_t* box = plane.data + rows.first * plane.stride_bytes + cols.first;
    // Column sums over the rows with red samples, and over the rows with blue samples.
    uint32_t columns[2][kMaxSamples] = {};
    for (int row = 0; row < samples; ++row, box += plane.stride_bytes) {
      uint32_t* sums = columns[(rows.first + row + red_row) & 1];
      for (int col = 0; col < samples; ++col) sums[col] += rows.weights[row] * box[col];
    }
    uint32_t mean[2][2] = {};
    for (int col = 0; col < samples; ++col) {
      const int lattice = (cols.first + col + red_col) & 1;
      mean[0][lattice] += cols.weights[col] * columns[0][col];
      mean[1][lattice] += cols.weights[col] * columns[1][col];
    }
    const auto to_network = [](uint32_t sum, int bits) __attribute__((always_inline)) {
      return static_cast<int8_t>(((sum + (1U << (bits - 1))) >> bits) - 128);
    };
    planes[i] = to_network(mean[0][0], 2 * kLatticeBits);
    planes[kNetworkPixels + i] = to_network(mean[0][1] + mean[1][0], 2 * kLatticeBits + 1);
    planes[2 * kNetworkPixels + i] = to_network(mean[1][1], 2 * kLatticeBits);
  }
}

/// Common tap counts are compile-time constants, as in rgb_remap.cpp.
BEVLOC_TARGET_CLONES
void remap_range(const ImageView& image, const RemapTable& table, PixelRange range, int red_row,
                 int red_col, int8_t* planes) {
  switch (table.taps) {
    case 3:
      return remap_pixels(image, table, range, red_row, red_col, 3, planes);
    case 5:
      return remap_pixels(image, table, range, red_row, red_col, 5, planes);
    default:
      return remap_pixels(image, table, range, red_row, red_col, table.taps, planes);
  }
}

}  // namespace

void remap_bayer_plain(const ImageView& image, const RemapTable& table, PixelRange range,
                       int8_t* planes) {
  const auto [row, col] = red_of(image.format);
  remap_range(image, table, range, row, col, planes);
}

}  // namespace bevloc
