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

/// The samples of the boxes of a part of a block.
class RgbSamples {
 public:
  RgbSamples(const RgbView& image, const Corners& corners)
      : image_(image),
        offsets_(corners.rows, image.stride_bytes, vmulq_n_u16(corners.cols, kSampleBytes)) {}

  template <int kTaps>
  void prefetch() const {
    prefetch_below<kTaps, kSampleBytes>(image_.data + offsets_[0], image_.stride_bytes);
  }

  template <int kRow, int kGroup>
  uint8x16_t at(int pixel) const {
    static constexpr Shuffle kByChannel([](int i) { return i < 12 ? 3 * (i % 4) + i / 4 : kNone; });
    const uint8_t* const line = image_.data + kRow * image_.stride_bytes;
    return kByChannel(vld1q_u8(line + offsets_[pixel] + 4 * kSampleBytes * kGroup));
  }

 private:
  static constexpr int kSampleBytes = 3;

  const RgbView& image_;
  Offsets offsets_;
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
          const RgbSamples samples(image, Corners(blocks, part));
          samples.prefetch<kTaps>();
          add_boxes<kTaps>(samples, blocks, part, sums);
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
