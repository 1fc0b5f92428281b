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

/// A box in YUYV (kLuma = 0) or UYVY (kLuma = 1): eight pixels in sixteen bytes.
template <int kLuma>
struct PackedPlace {
  const uint8_t* first;
  std::ptrdiff_t stride_bytes;

  PackedPlace(const YuvLayout& image, Corner corner)
      : first(image.y.data - kLuma + corner.row * image.y.stride_bytes + 2 * corner.col),
        stride_bytes(image.y.stride_bytes) {}

  template <int kTaps>
  void prefetch(const YuvLayout&) const {
    prefetch_below<kTaps, 2>(first, stride_bytes);
  }

  template <int kRow, int kGroup>
  uint8x16_t samples() const {
    static constexpr Shuffle kByChannel([](int i) {
      const int chroma = 4 * (i % 4 / 2) + 1 - kLuma;
      const int from[] = {2 * (i % 4) + kLuma, chroma, chroma + 2, kNone};
      return from[i / 4] == kNone ? kNone : 8 * kGroup + from[i / 4];
    });
    return kByChannel(vld1q_u8(first + kRow * stride_bytes));
  }
};

/// A box in a format with luma in a separate plane.
template <bool kHalvedRows>
class PlanarPlace {
 protected:
  PlanarPlace(const YuvLayout& image, Corner corner)
      : luma_(image.y.data + corner.row * image.y.stride_bytes + corner.col),
        luma_stride_bytes_(image.y.stride_bytes),
        chroma_stride_bytes_(image.u.stride_bytes) {
    const int in_row = image.chroma_step == 2 ? corner.col : corner.col / 2;
    const int first_row = kHalvedRows ? corner.row / 2 : corner.row;
    const int second_row = kHalvedRows ? (corner.row + 1) / 2 : corner.row;
    chroma_[0] = first_row * chroma_stride_bytes_ + in_row;
    chroma_[1] = second_row * chroma_stride_bytes_ + in_row;
  }

  template <int kRow>
  uint8x8_t luma() const {
    return vld1_u8(luma_ + kRow * luma_stride_bytes_);
  }
  /// Offset of the first chroma sample of a row of the box.
  template <int kRow>
  std::ptrdiff_t chroma() const {
    return chroma_[kRow % 2] + (kHalvedRows ? kRow / 2 : kRow) * chroma_stride_bytes_;
  }

  const uint8_t* luma_;
  std::ptrdiff_t luma_stride_bytes_;
  std::ptrdiff_t chroma_stride_bytes_;
  std::ptrdiff_t chroma_[2];  ///< of rows 0, 2, ... and of rows 1, 3, ...
};

/// A box in NV12.
class SemiPlanarPlace : PlanarPlace<true> {
 public:
  SemiPlanarPlace(const YuvLayout& image, Corner corner)
      : PlanarPlace(image, corner), chroma_plane_(image.u.data) {}

  template <int kTaps>
  void prefetch(const YuvLayout& image) const {
    prefetch_below<kTaps, 1>(luma_, image.y.stride_bytes);
    prefetch_below<kTaps, 2, 1, 1>(chroma_plane_ + chroma_[0], image.u.stride_bytes);
  }

  template <int kRow, int kGroup>
  uint8x16_t samples() const {
    static constexpr Shuffle kByChannel([](int i) {
      const int chroma = 8 + 4 * kGroup + 2 * (i % 4 / 2);
      const int from[] = {4 * kGroup + i % 4, chroma, chroma + 1, kNone};
      return from[i / 4];
    });
    return kByChannel(vcombine_u8(luma<kRow>(), vld1_u8(chroma_plane_ + chroma<kRow>())));
  }

 private:
  const uint8_t* chroma_plane_;
};

/// A box in 4:2:0 or 4:2:2 in three planes.
template <bool kHalvedRows>
class ThreePlanesPlace : PlanarPlace<kHalvedRows> {
  using Base = PlanarPlace<kHalvedRows>;

 public:
  ThreePlanesPlace(const YuvLayout& image, Corner corner)
      : Base(image, corner), u_(image.u.data), v_(image.v.data) {}

  template <int kTaps>
  void prefetch(const YuvLayout& image) const {
    constexpr int kRowShift = kHalvedRows ? 1 : 0;
    prefetch_below<kTaps, 1>(this->luma_, image.y.stride_bytes);
    for (const ImagePlane& plane : {image.u, image.v}) {
      prefetch_below<kTaps, 1, kRowShift, 1>(plane.data + this->chroma_[0], plane.stride_bytes);
    }
  }

  template <int kRow, int kGroup>
  uint8x16_t samples() const {
    static constexpr Shuffle kByChannel([](int i) {
      const int chroma = 8 + 2 * kGroup + i % 4 / 2;
      const int from[] = {4 * kGroup + i % 4, chroma, chroma + 4, kNone};
      return from[i / 4];
    });
    const std::ptrdiff_t chroma = Base::template chroma<kRow>();
    const uint32x2_t both = {word(u_ + chroma), word(v_ + chroma)};
    return kByChannel(vcombine_u8(Base::template luma<kRow>(), vreinterpret_u8_u32(both)));
  }

 private:
  static uint32_t word(const uint8_t* from) {
    uint32_t bytes = 0;
    std::memcpy(&bytes, from, sizeof(bytes));
    return bytes;
  }

  const uint8_t* u_;
  const uint8_t* v_;
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

template <int kTaps, int kParts, typename Place>
void remap_blocks(const YuvLayout& image, const RemapBlocks& blocks, int8_t* planes) {
  const ToRgb to_rgb(rgb_from_yuv(image.encoding));
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    Sums sums[kPixels];
    for (Sums& sum : sums) sum = vdupq_n_u32(0);
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          Place(image, Corner(blocks, part, 0)).template prefetch<kTaps>(image);
          for (int pixel = 0; pixel < kPixels; ++pixel) {
            const Place place(image, Corner(blocks, part, pixel));
            sums[pixel] = box_sums<kTaps>(place, blocks, part, pixel, sums[pixel]);
          }
        });
    to_rgb.store(SumsByKind(sums), planes + kPixels * blocks.index[block]);
  }
}

struct Readers {
  using Yuyv = PackedPlace<0>;
  using Uyvy = PackedPlace<1>;
  using Nv12 = SemiPlanarPlace;
  using I420 = ThreePlanesPlace<true>;
  using I422 = ThreePlanesPlace<false>;
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
