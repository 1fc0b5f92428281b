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

template <int kTaps>
constexpr int kSlots = RemapBlocks::slots(kTaps);

/// Weights of the columns, each divided into two bytes: the box weight of the column plus the mean
/// of its neighbours' box weights, rounded down in one and rounded up in the other.
struct ColumnWeights {
  uint8x16_t down;
  uint8x16_t up;
};

template <int kTaps>
ColumnWeights lattice_cols(uint8x16_t weights) {
  constexpr auto moved = [](int by) {
    return Shuffle([by](int i) {
      const int slot = bayer_column<kTaps>(i) - 1 + by;
      return slot >= 0 && slot < kSlots<kTaps> ? slot : kNone;
    });
  };
  static constexpr Shuffle kBefore = moved(-1);
  static constexpr Shuffle kOwn = moved(0);
  static constexpr Shuffle kAfter = moved(1);
  const uint8x16_t own = kOwn(weights);
  const uint8x16_t before = kBefore(weights);
  const uint8x16_t after = kAfter(weights);
  return {vaddq_u8(own, vhaddq_u8(before, after)), vaddq_u8(own, vrhaddq_u8(before, after))};
}

/// Weights of twelve rows: twice the box weight of the row plus those of its neighbours. Row 0 is
/// the row above the box.
template <int kTaps>
void lattice_rows(uint8x16_t weights, uint32x4_t (&rows)[3]) {
  const uint16x8_t zero = vdupq_n_u16(0);
  const uint16x8_t box = kSlots<kTaps> == 4
                             ? vmovl_u8(vext_u8(vget_low_u8(weights), vdup_n_u8(0), 4))
                             : vmovl_high_u8(weights);
  const auto sum = [](uint16x8_t before, uint16x8_t own, uint16x8_t after) {
    return vaddq_u16(vaddq_u16(own, own), vaddq_u16(before, after));
  };
  const uint16x8_t upper = sum(vextq_u16(zero, box, 6), vextq_u16(zero, box, 7), box);
  const uint16x8_t lower = sum(vextq_u16(box, zero, 6), vextq_u16(box, zero, 7), zero);
  rows[0] = vmovl_u16(vget_low_u16(upper));
  rows[1] = vmovl_high_u16(upper);
  rows[2] = vmovl_u16(vget_low_u16(lower));
}

/// Weighted sums of odd columns (two lanes) and of even columns (two lanes).
template <int kTaps>
[[gnu::always_inline]] inline Sums line_sums(const uint8_t* first, const ColumnWeights& cols) {
  static constexpr Shuffle kByColumn([](int i) { return bayer_column<kTaps>(i); });
  if constexpr (kBayerColumns<kTaps> == 4) {
    const uint8x16_t samples = kByColumn(vcombine_u8(vld1_u8(first), vdup_n_u8(0)));
    return vdotq_u32(vdupq_n_u32(0), samples, cols.down);
  } else {
    const uint8x16_t samples = kByColumn(vld1q_u8(first));
    return vdotq_u32(vdotq_u32(vdupq_n_u32(0), samples, cols.down), samples, cols.up);
  }
}

/// Four weighted sums of a pixel: over odd and even columns of rows 0, 2, ..., then over those of
/// rows 1, 3, ...
template <int kTaps>
[[gnu::always_inline]] inline Sums lattice_sums(const ImagePlane& plane, Corner corner,
                                                uint8x16_t weights) {
  ColumnWeights cols = lattice_cols<kTaps>(weights);
  if constexpr (kBayerColumns<kTaps> == 4) {
    // The samples are there twice: once for each of the divided weights.
    const uint8x16_t is_second = vreinterpretq_u8_u64(vdupq_n_u64(0xFFFFFFFF'00000000));
    cols.down = vbslq_u8(is_second, cols.up, cols.down);
  }
  uint32x4_t rows[3];
  lattice_rows<kTaps>(weights, rows);
  const uint8_t* const first = plane.data + (corner.row - 1) * plane.stride_bytes + corner.col - 1;
  Sums halves[2] = {vdupq_n_u32(0), vdupq_n_u32(0)};
  repeat<kTaps + 2>([&](auto row) __attribute__((always_inline)) {
    const Sums line = line_sums<kTaps>(first + row() * plane.stride_bytes, cols);
    halves[row() % 2] = add_line<row()>(halves[row() % 2], line, rows);
  });
  return vpaddq_u32(halves[0], halves[1]);
}

/// Writes red, green and blue from the four sums of each pixel. What a sum belongs to depends on
/// whether the first row of the box is even or odd in the frame; the columns are always aligned to
/// the frame.
class Colours {
 public:
  Colours(const SumsByKind& sums, const uint16_t* first_rows, RedPixel red)
      : sums_(sums), red_col_(red.col == 0 ? 1 : 0) {
    // The sums start in the row above the box.
    const uint16x8_t parity =
        veorq_u16(vld1q_u16(first_rows), vdupq_n_u16(static_cast<uint16_t>(1 + red.row)));
    const int16x8_t is_odd = vreinterpretq_s16_u16(vtstq_u16(parity, vdupq_n_u16(1)));
    swapped_.low = vreinterpretq_u32_s32(vmovl_s16(vget_low_s16(is_odd)));
    swapped_.high = vreinterpretq_u32_s32(vmovl_high_s16(is_odd));
  }

  void store(int8_t* planes) const {
    const int blue_col = 1 - red_col_;
    const Eight greens[2] = {chosen(blue_col, 2 + blue_col), chosen(2 + red_col_, red_col_)};
    const Eight green{vaddq_u32(greens[0].low, greens[1].low),
                      vaddq_u32(greens[0].high, greens[1].high)};
    store_pixels(mean<kRedBits>(chosen(red_col_, 2 + red_col_)), planes);
    store_pixels(mean<kRedBits + 1>(green), planes + kNetworkPixels);
    store_pixels(mean<kRedBits>(chosen(2 + blue_col, blue_col)), planes + 2 * kNetworkPixels);
  }

 private:
  using Eight = SumsByKind::Eight;
  static constexpr int kRedBits = 2 * (RemapTable::kWeightBits + 1);

  Eight chosen(int first, int swapped) const {
    return {vbslq_u32(swapped_.low, sums_.kinds[swapped].low, sums_.kinds[first].low),
            vbslq_u32(swapped_.high, sums_.kinds[swapped].high, sums_.kinds[first].high)};
  }
  /// The rounded mean from sums whose weights sum to 2^kBits.
  template <int kBits>
  static uint8x8_t mean(Eight sums) {
    const uint16x4_t low = vmovn_u32(vrshrq_n_u32(sums.low, kBits));
    return vmovn_u16(vmovn_high_u32(low, vrshrq_n_u32(sums.high, kBits)));
  }

  const SumsByKind& sums_;
  int red_col_;
  Eight swapped_;
};

template <int kTaps, int kParts>
void remap_blocks(const ImageView& image, const RemapBlocks& blocks, int8_t* planes) {
  const ImagePlane& plane = image.planes[0];
  const RedPixel red = red_of(image.format);
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    Sums sums[kPixels];
    for (Sums& sum : sums) sum = vdupq_n_u32(0);
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          const Corner corner(blocks, part, 0);
          prefetch_below<kTaps, 1>(plane.data + (corner.row + 1) * plane.stride_bytes + corner.col,
                                   plane.stride_bytes);
          for (int pixel = 0; pixel < kPixels; ++pixel) {
            const uint8x16_t weights = load_weights<kSlots<kTaps>>(blocks, part, pixel);
            sums[pixel] = vaddq_u32(
                sums[pixel], lattice_sums<kTaps>(plane, Corner(blocks, part, pixel), weights));
          }
        });
    // The first rows of all parts have the same parity.
    const uint16_t* const first_rows = blocks.first_row.data() + kPixels * kParts * block;
    Colours(SumsByKind(sums), first_rows, red).store(planes + kPixels * blocks.index[block]);
  }
}

}  // namespace

BlockKernel<ImageView>* bayer_block_kernel(int taps) {
  return kernel_of_taps(taps, [](auto shape) -> BlockKernel<ImageView>* {
    return remap_blocks<shape.taps, shape.parts>;
  });
}

}  // namespace bevloc
#endif
