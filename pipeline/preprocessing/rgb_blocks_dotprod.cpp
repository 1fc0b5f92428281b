#include "pipeline/preprocessing/block_kernels.h"

#ifdef __aarch64__
#include <type_traits>
#include <utility>

#include <arm_neon.h>

#pragma GCC target("arch=armv8.2-a+dotprod")

namespace bevloc {
namespace {

#include "pipeline/preprocessing/block_shapes.h"
#include "pipeline/preprocessing/blocks_dotprod.h"
#include "pipeline/preprocessing/boxes_dotprod.h"

/// The first sample of a box.
struct RgbPlace {
  const uint8_t* first;
  std::ptrdiff_t stride_bytes;

  RgbPlace(const RgbView& image, Corner corner)
      : first(image.data + corner.row * image.stride_bytes + 3 * corner.col),
        stride_bytes(image.stride_bytes) {}

  template <int kRow, int kGroup>
  uint8x16_t samples() const {
    static constexpr Shuffle kByChannel([](int i) { return i < 12 ? 3 * (i % 4) + i / 4 : kNone; });
    return kByChannel(vld1q_u8(first + kRow * stride_bytes + 12 * kGroup));
  }
};

/// Writes the means, which are the third bytes of the sums.
void store_means(const Sums (&pixels)[kPixels], int8_t* planes) {
  static constexpr Shuffle kByChannel([](int i) { return 16 * (i % 4) + 4 * (i / 4) + 2; });
  uint32x4_t halves[2];
  for (int half = 0; half < 2; ++half) {
    uint8x16x4_t table;
    for (int i = 0; i < 4; ++i) table.val[i] = vreinterpretq_u8_u32(pixels[4 * half + i]);
    halves[half] = vreinterpretq_u32_u8(vqtbl4q_u8(table, vld1q_u8(kByChannel.bytes)));
  }
  const uint8x16_t red_green = vreinterpretq_u8_u32(vzip1q_u32(halves[0], halves[1]));
  const uint8x16_t blue = vreinterpretq_u8_u32(vzip2q_u32(halves[0], halves[1]));
  store_pixels(vget_low_u8(red_green), planes);
  store_pixels(vget_high_u8(red_green), planes + kNetworkPixels);
  store_pixels(vget_low_u8(blue), planes + 2 * kNetworkPixels);
}

template <int kTaps, int kParts>
void remap_blocks(const RgbView& image, const RemapBlocks& blocks, int8_t* planes) {
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    Sums sums[kPixels];
    for (Sums& sum : sums) sum = vdupq_n_u32(1U << (2 * RemapTable::kWeightBits - 1));
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          prefetch_below<kTaps, 3>(RgbPlace(image, Corner(blocks, part, 0)).first,
                                   image.stride_bytes);
          for (int pixel = 0; pixel < kPixels; ++pixel) {
            const RgbPlace place(image, Corner(blocks, part, pixel));
            sums[pixel] = box_sums<kTaps>(place, blocks, part, pixel, sums[pixel]);
          }
        });
    store_means(sums, planes + kPixels * blocks.index[block]);
  }
}

}  // namespace

BlockKernel<RgbView>* rgb_block_kernel(int taps) {
  return kernel_of_taps(taps, [](auto shape) -> BlockKernel<RgbView>* {
    return remap_blocks<shape.taps, shape.parts>;
  });
}

}  // namespace bevloc
#endif
