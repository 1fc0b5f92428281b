#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/preprocessing/format_remap.h"
#include "pipeline/preprocessing/yuv_colour.h"

namespace bevloc {
namespace {

constexpr int kSumBits = 2 * RemapTable::kWeightBits;  // the weights of a box sum to 2^kSumBits
constexpr int kSampleBits = RgbFromYuv::kSampleBits;

int8_t to_network(int32_t fixed) {
  constexpr int kBits = kSampleBits + RgbFromYuv::kCoefficientBits;
  const int32_t value = (fixed + (1 << (kBits - 1))) >> kBits;
  return static_cast<int8_t>(std::clamp(value, 0, 255) - 128);
}

/// Weights of the chroma samples of a box. The weights of pixels that share a sample are added.
struct ChromaWeights {
  int first = 0;
  int count = 0;
  uint16_t weights[RemapTable::kMaxTaps] = {};

  [[gnu::always_inline]] ChromaWeights(int first_sample, int shift, const uint16_t* box, int taps)
      : first(first_sample >> shift), count(samples(first_sample, shift, taps)) {
    for (int i = 0; i < count; ++i) weights[i] = 0;
    for (int i = 0; i < taps; ++i) {
      uint16_t& weight = weights[((first_sample + i) >> shift) - first];
      weight = static_cast<uint16_t>(weight + box[i]);
    }
  }

  /// Number of chroma samples. For an odd number of pixels it does not depend on the first pixel,
  /// so it is a compile-time constant.
  [[gnu::always_inline]] static int samples(int first_sample, int shift, int taps) {
    if (shift == 0) return taps;
    if (taps % 2 == 1) return taps / 2 + 1;
    return ((first_sample + taps - 1) >> shift) - (first_sample >> shift) + 1;
  }
};

template <int kStep>
[[gnu::always_inline]] inline int32_t box_mean(const uint8_t* box, std::ptrdiff_t stride_bytes,
                                               const uint16_t* col_weights, int cols,
                                               const uint16_t* row_weights, int rows) {
  uint32_t sum = 0;
  for (int row = 0; row < rows; ++row, box += stride_bytes) {
    uint32_t line = 0;
    for (int col = 0; col < cols; ++col) line += col_weights[col] * box[col * kStep];
    sum += row_weights[row] * line;
  }
  return static_cast<int32_t>(sum >> (kSumBits - kSampleBits));
}

template <int kLumaStep, int kChromaStep, int kShiftX, int kShiftY>
[[gnu::always_inline]] inline void remap_pixels(const YuvLayout& image, const RemapTable& table,
                                                PixelRange range, const RgbFromYuv& colour,
                                                int taps, int8_t* planes) {
  constexpr int32_t kNoColour = 128 << kSampleBits;
  const uint16_t* weights = table.weights.data() + 2 * taps * range.begin;
  for (int i = range.begin; i < range.end; ++i, weights += 2 * taps) {
    int weight_sum = 0;
    for (int col = 0; col < taps; ++col) weight_sum += weights[col];
    if (weight_sum == 0) {
      for (int c = 0; c < 3; ++c) planes[c * kNetworkPixels + i] = -128;
      continue;
    }
    const int first_col = table.first_col[i];
    const int first_row = table.first_row[i];
    const uint8_t* box = image.y.data + first_row * image.y.stride_bytes + first_col * kLumaStep;
    const int32_t luma = colour.luma * (box_mean<kLumaStep>(box, image.y.stride_bytes, weights,
                                                            taps, weights + taps, taps) -
                                        colour.black);
    const ChromaWeights cols(first_col, kShiftX, weights, taps);
    const ChromaWeights rows(first_row, kShiftY, weights + taps, taps);
    const auto chroma = [&](const ImagePlane& plane) __attribute__((always_inline)) {
      const uint8_t* first =
          plane.data + rows.first * plane.stride_bytes + cols.first * kChromaStep;
      return box_mean<kChromaStep>(first, plane.stride_bytes, cols.weights, cols.count,
                                   rows.weights, rows.count) -
             kNoColour;
    };
    const int32_t u = chroma(image.u);
    const int32_t v = chroma(image.v);
    planes[i] = to_network(luma + colour.red_v * v);
    planes[kNetworkPixels + i] = to_network(luma - colour.green_u * u - colour.green_v * v);
    planes[2 * kNetworkPixels + i] = to_network(luma + colour.blue_u * u);
  }
}

/// Common tap counts are compile-time constants, as in rgb_remap.cpp.
template <int kLumaStep, int kChromaStep, int kShiftX, int kShiftY>
[[gnu::always_inline]] inline void remap_taps(const YuvLayout& image, const RemapTable& table,
                                              PixelRange range, const RgbFromYuv& colour,
                                              int8_t* planes) {
  switch (table.taps) {
    case 3:
      return remap_pixels<kLumaStep, kChromaStep, kShiftX, kShiftY>(image, table, range, colour, 3,
                                                                    planes);
    case 5:
      return remap_pixels<kLumaStep, kChromaStep, kShiftX, kShiftY>(image, table, range, colour, 5,
                                                                    planes);
    default:
      return remap_pixels<kLumaStep, kChromaStep, kShiftX, kShiftY>(image, table, range, colour,
                                                                    table.taps, planes);
  }
}

/// Selects the code for packed 4:2:2, NV12, or a planar JPEG layout: 4:2:0, 4:2:2, 4:4:0, 4:4:4.
BEVLOC_TARGET_CLONES
void remap_range(const YuvLayout& image, const RemapTable& table, PixelRange range,
                 const RgbFromYuv& colour, int8_t* planes) {
  const bool is_halved_x = image.chroma_shift_x == 1;
  const bool is_halved_y = image.chroma_shift_y == 1;
  if (image.y_step == 2) return remap_taps<2, 4, 1, 0>(image, table, range, colour, planes);
  if (image.chroma_step == 2) return remap_taps<1, 2, 1, 1>(image, table, range, colour, planes);
  if (is_halved_x && is_halved_y)
    return remap_taps<1, 1, 1, 1>(image, table, range, colour, planes);
  if (is_halved_x) return remap_taps<1, 1, 1, 0>(image, table, range, colour, planes);
  if (is_halved_y) return remap_taps<1, 1, 0, 1>(image, table, range, colour, planes);
  remap_taps<1, 1, 0, 0>(image, table, range, colour, planes);
}

}  // namespace

void remap_yuv_plain(const YuvLayout& image, const RemapTable& table, PixelRange range,
                     int8_t* planes) {
  remap_range(image, table, range, rgb_from_yuv(image.encoding), planes);
}

}  // namespace bevloc
