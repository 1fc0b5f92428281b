#include "pipeline/preprocessing/block_kernels.h"

#ifdef __aarch64__
#include <cstring>
#include <type_traits>
#include <utility>

#include <arm_neon.h>

#include "pipeline/preprocessing/yuv_colour.h"

#pragma GCC target("arch=armv8.2-a+dotprod")

namespace bevloc {
namespace {

#include "pipeline/preprocessing/block_shapes.h"
#include "pipeline/preprocessing/blocks_dotprod.h"
#include "pipeline/preprocessing/boxes_dotprod.h"

/// The samples of boxes in YUYV (kLuma = 0) or UYVY (kLuma = 1): eight pixels in sixteen bytes.
template <int kLuma>
class PackedSamples {
 public:
  PackedSamples(const YuvLayout& image, const Corners& corners)
      : first_(image.y.data - kLuma),
        stride_bytes_(image.y.stride_bytes),
        offsets_(corners.rows, stride_bytes_, vshlq_n_u16(corners.cols, 1)) {}

  template <int kTaps>
  void prefetch() const {
    prefetch_below<kTaps, 2>(first_ + offsets_[0], stride_bytes_);
  }

  template <int kRow, int kGroup>
  uint8x16_t at(int pixel) const {
    static constexpr Shuffle kByChannel([](int i) {
      const int chroma = 4 * (i % 4 / 2) + 1 - kLuma;
      const int from[] = {2 * (i % 4) + kLuma, chroma, chroma + 2, kNone};
      return from[i / 4] == kNone ? kNone : 8 * kGroup + from[i / 4];
    });
    return kByChannel(vld1q_u8(first_ + kRow * stride_bytes_ + offsets_[pixel]));
  }

 private:
  const uint8_t* first_;
  std::ptrdiff_t stride_bytes_;
  Offsets offsets_;
};

/// The samples of boxes in a format with luma in a separate plane. kColShift is 1 if a chroma plane
/// has half as many columns of bytes as that of luma.
template <bool kHalvedRows, int kColShift>
class PlanarSamples {
 protected:
  PlanarSamples(const YuvLayout& image, const Corners& corners)
      : image_(image),
        luma_(corners.rows, image.y.stride_bytes, corners.cols),
        chroma_{chroma_offsets<0>(image, corners), chroma_offsets<1>(image, corners)} {}

  template <int kRow>
  uint8x8_t luma(int pixel) const {
    return vld1_u8(image_.y.data + kRow * image_.y.stride_bytes + luma_[pixel]);
  }
  /// The first chroma sample of a row of the box.
  template <int kRow>
  const uint8_t* chroma(const ImagePlane& plane, int pixel) const {
    const int row = kHalvedRows ? kRow / 2 : kRow;
    return plane.data + row * plane.stride_bytes + chroma_[kHalvedRows ? kRow % 2 : 0][pixel];
  }
  template <int kTaps>
  void prefetch_luma() const {
    prefetch_below<kTaps, 1>(image_.y.data + luma_[0], image_.y.stride_bytes);
  }

  const YuvLayout& image_;

 private:
  /// The offsets of the chroma of row kFirstRow of the boxes.
  template <int kFirstRow>
  static Offsets chroma_offsets(const YuvLayout& image, const Corners& corners) {
    uint16x8_t rows = corners.rows;
    if constexpr (kHalvedRows) rows = vshrq_n_u16(vaddq_u16(rows, vdupq_n_u16(kFirstRow)), 1);
    uint16x8_t cols = corners.cols;
    if constexpr (kColShift == 1) cols = vshrq_n_u16(cols, 1);
    return Offsets(rows, image.u.stride_bytes, cols);
  }

  Offsets luma_;
  Offsets chroma_[2];  ///< offsets for rows 0, 2, ... and for rows 1, 3, ...
};

/// The samples of boxes in NV12.
class SemiPlanarSamples : PlanarSamples<true, 0> {
 public:
  SemiPlanarSamples(const YuvLayout& image, const Corners& corners)
      : PlanarSamples(image, corners) {}

  template <int kTaps>
  void prefetch() const {
    prefetch_luma<kTaps>();
    prefetch_below<kTaps, 2, 1, 1>(chroma<0>(image_.u, 0), image_.u.stride_bytes);
  }

  template <int kRow, int kGroup>
  uint8x16_t at(int pixel) const {
    static constexpr Shuffle kByChannel([](int i) {
      const int chroma = 8 + 4 * kGroup + 2 * (i % 4 / 2);
      const int from[] = {4 * kGroup + i % 4, chroma, chroma + 1, kNone};
      return from[i / 4];
    });
    return kByChannel(vcombine_u8(luma<kRow>(pixel), vld1_u8(chroma<kRow>(image_.u, pixel))));
  }
};

/// The samples of boxes in 4:2:0 or 4:2:2 in three planes.
template <bool kHalvedRows>
class ThreePlanesSamples : PlanarSamples<kHalvedRows, 1> {
  using Base = PlanarSamples<kHalvedRows, 1>;
  using Base::image_;

 public:
  ThreePlanesSamples(const YuvLayout& image, const Corners& corners) : Base(image, corners) {}

  template <int kTaps>
  void prefetch() const {
    constexpr int kRowShift = kHalvedRows ? 1 : 0;
    Base::template prefetch_luma<kTaps>();
    for (const ImagePlane& plane : {image_.u, image_.v}) {
      prefetch_below<kTaps, 1, kRowShift, 1>(Base::template chroma<0>(plane, 0),
                                             plane.stride_bytes);
    }
  }

  template <int kRow, int kGroup>
  uint8x16_t at(int pixel) const {
    static constexpr Shuffle kByChannel([](int i) {
      const int chroma = 8 + 2 * kGroup + i % 4 / 2;
      const int from[] = {4 * kGroup + i % 4, chroma, chroma + 4, kNone};
      return from[i / 4];
    });
    const uint32x2_t both = {word(Base::template chroma<kRow>(image_.u, pixel)),
                             word(Base::template chroma<kRow>(image_.v, pixel))};
    return kByChannel(vcombine_u8(Base::template luma<kRow>(pixel), vreinterpret_u8_u32(both)));
  }

 private:
  static uint32_t word(const uint8_t* from) {
    uint32_t bytes = 0;
    std::memcpy(&bytes, from, sizeof(bytes));
    return bytes;
  }
};

/// Converts the sums of eight pixels to RGB, with the same bits as the plain code.
class ToRgb {
 public:
  explicit ToRgb(const RgbFromYuv& colour) : colour_(colour) {}

  void store(const SumsByKind& yuv, int8_t* planes) const {
    const Rgb low = rgb(yuv.kinds[0].low, yuv.kinds[1].low, yuv.kinds[2].low);
    const Rgb high = rgb(yuv.kinds[0].high, yuv.kinds[1].high, yuv.kinds[2].high);
    for (int channel = 0; channel < 3; ++channel) {
      const int16x8_t words =
          vqmovn_high_s32(vqmovn_s32(low.channels[channel]), high.channels[channel]);
      store_pixels(vqmovun_s16(words), planes + channel * kNetworkPixels);
    }
  }

 private:
  struct Rgb {
    int32x4_t channels[3];
  };
  static constexpr int kSumBits = 2 * RemapTable::kWeightBits;
  static constexpr int kSampleBits = RgbFromYuv::kSampleBits;
  static constexpr int kBits = kSampleBits + RgbFromYuv::kCoefficientBits;

  /// The mean with kSampleBits fractional bits, minus `zero`.
  static int32x4_t mean(uint32x4_t sums, int32_t zero) {
    return vsubq_s32(vreinterpretq_s32_u32(vshrq_n_u32(sums, kSumBits - kSampleBits)),
                     vdupq_n_s32(zero));
  }
  Rgb rgb(uint32x4_t y_sums, uint32x4_t u_sums, uint32x4_t v_sums) const {
    const int32x4_t u = mean(u_sums, 128 << kSampleBits);
    const int32x4_t v = mean(v_sums, 128 << kSampleBits);
    const int32x4_t luma = vmulq_n_s32(mean(y_sums, colour_.black), colour_.luma);
    const int32x4_t green = vmlsq_n_s32(vmlsq_n_s32(luma, u, colour_.green_u), v, colour_.green_v);
    return {{vrshrq_n_s32(vmlaq_n_s32(luma, v, colour_.red_v), kBits), vrshrq_n_s32(green, kBits),
             vrshrq_n_s32(vmlaq_n_s32(luma, u, colour_.blue_u), kBits)}};
  }

  RgbFromYuv colour_;
};

template <int kTaps, int kParts, typename Samples>
void remap_blocks(const YuvLayout& image, const RemapBlocks& blocks, int8_t* planes) {
  const ToRgb to_rgb(rgb_from_yuv(image.encoding));
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    Sums sums[kPixels];
    for (Sums& sum : sums) sum = vdupq_n_u32(0);
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          const Samples samples(image, Corners(blocks, part));
          samples.template prefetch<kTaps>();
          add_boxes<kTaps>(samples, blocks, part, sums);
        });
    to_rgb.store(SumsByKind(sums), planes + kPixels * blocks.index[block]);
  }
}

struct Readers {
  using Yuyv = PackedSamples<0>;
  using Uyvy = PackedSamples<1>;
  using Nv12 = SemiPlanarSamples;
  using I420 = ThreePlanesSamples<true>;
  using I422 = ThreePlanesSamples<false>;
};

}  // namespace

BlockKernel<YuvLayout>* yuv_block_kernel(const YuvLayout& layout, int taps) {
  return kernel_of_layout<Readers>(layout, [taps]<typename Reader>() {
    return kernel_of_taps(taps, [](auto shape) -> BlockKernel<YuvLayout>* {
      return remap_blocks<shape.taps, shape.parts, Reader>;
    });
  });
}

}  // namespace bevloc
#endif
