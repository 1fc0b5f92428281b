#include "common/target_clones.h"
#include "pipeline/preprocessing/format_remap.h"

namespace bevloc {
namespace {

/// Sums the rows of a box first, because contiguous bytes vectorise, then the columns.
[[gnu::always_inline]] inline void remap_pixels(const RgbView& image, const RemapTable& table,
                                                PixelRange range, int taps, int8_t* planes) {
  const uint16_t* weights = table.weights.data() + 2 * taps * range.begin;
  for (int i = range.begin; i < range.end; ++i, weights += 2 * taps) {
    const uint8_t* box =
        image.data + table.first_row[i] * image.stride_bytes + 3 * table.first_col[i];
    uint16_t columns[3 * RemapTable::kMaxTaps] = {};
    for (int row = 0; row < taps; ++row, box += image.stride_bytes) {
      const uint16_t weight = weights[taps + row];
      for (int j = 0; j < 3 * taps; ++j) {
        columns[j] = static_cast<uint16_t>(columns[j] + weight * box[j]);
      }
    }
    for (int channel = 0; channel < 3; ++channel) {
      uint32_t sum = 1U << (2 * RemapTable::kWeightBits - 1);
      for (int col = 0; col < taps; ++col) sum += columns[3 * col + channel] * weights[col];
      planes[channel * kNetworkPixels + i] =
          static_cast<int8_t>((sum >> (2 * RemapTable::kWeightBits)) - 128);
    }
  }
}

/// Common tap counts (images 320 to 1280 pixels wide) are compile-time constants.
BEVLOC_TARGET_CLONES
void remap_range(const RgbView& image, const RemapTable& table, PixelRange range, int8_t* planes) {
  switch (table.taps) {
    case 2:
      return remap_pixels(image, table, range, 2, planes);
    case 3:
      return remap_pixels(image, table, range, 3, planes);
    case 4:
      return remap_pixels(image, table, range, 4, planes);
    case 5:
      return remap_pixels(image, table, range, 5, planes);
    default:
      return remap_pixels(image, table, range, table.taps, planes);
  }
}

}  // namespace

void remap_rgb_plain(const RgbView& image, const RemapTable& table, PixelRange range,
                     int8_t* planes) {
  remap_range(image, table, range, planes);
}

}  // namespace bevloc
