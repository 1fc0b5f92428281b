#include "pipeline/preprocessing/block_kernels.h"

#ifdef __x86_64__
#include <array>
#include <type_traits>
#include <utility>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc {
namespace {

#include "pipeline/preprocessing/block_shapes.h"
#include "pipeline/preprocessing/blocks_avx2.h"

template <int kTaps>
constexpr int kSlots = RemapBlocks::slots(kTaps);

/// Shuffles that fetch, for each sample along one axis, the box weights of its pixel and of the two
/// neighbours. The weight of the sample is twice its own box weight plus those of the neighbours.
/// slot_of(half, i, offset) is the source byte for byte i of a half, or kNone for 0.
struct Lattice {
  Shuffle before;
  Shuffle own;
  Shuffle after;

  template <typename SlotOf>
  explicit constexpr Lattice(const SlotOf& slot_of)
      : before(moved(slot_of, -1)), own(moved(slot_of, 0)), after(moved(slot_of, 1)) {}

 private:
  template <typename SlotOf>
  static constexpr Shuffle moved(const SlotOf& slot_of, int by) {
    return Shuffle([&slot_of, by](int half, int i) { return slot_of(half, i, by); });
  }
};

/// Weights of the columns. They may exceed a byte, so this returns half of each: rounded down where
/// the bytes of `down` are -1, rounded up elsewhere. Both results together sum to the weight.
template <int kTaps>
__m256i lattice_cols(__m256i weights, __m256i down) {
  static constexpr Lattice kCols([](int half, int i, int by) {
    const int slot = bayer_column<kTaps>(i) - 1 + by;
    return slot >= 0 && slot < kSlots<kTaps> ? col_weight<kSlots<kTaps>>(half, slot) : kNone;
  });
  // avg rounds up. Rounding up the complement of x rounds x down.
  const __m256i mean = _mm256_avg_epu8(_mm256_xor_si256(kCols.before(weights), down),
                                       _mm256_xor_si256(kCols.after(weights), down));
  return _mm256_add_epi8(kCols.own(weights), _mm256_xor_si256(mean, down));
}

/// Weights of eight rows, in words. Row 0 is the row above the box.
template <int kTaps, int kFirstRow>
__m256i lattice_rows(__m256i weights) {
  static constexpr Lattice kRows([](int half, int i, int by) {
    const int slot = kFirstRow + i / 2 - 1 + by;
    const bool is_one = i % 2 == 0 && slot >= 0 && slot < kSlots<kTaps>;
    return is_one ? kSlots<kTaps> + col_weight<kSlots<kTaps>>(half, slot) : kNone;
  });
  const __m256i own = kRows.own(weights);
  const __m256i neighbours = _mm256_add_epi16(kRows.before(weights), kRows.after(weights));
  return _mm256_add_epi16(_mm256_add_epi16(own, own), neighbours);
}

/// Copies one word to all words of a half.
constexpr Shuffle all_words(int word) {
  return Shuffle([word](int, int i) { return 2 * word + i % 2; });
}

/// Four weighted sums for each pixel of a pair: over odd and even columns of rows 0, 2, ..., then
/// over those of rows 1, 3, ...
template <int kTaps>
[[gnu::always_inline]] inline __m256i lattice_sums(const ImagePlane& plane, const Distances& place,
                                                   const RemapBlocks& blocks, size_t block,
                                                   int pair) {
  static constexpr Shuffle kByColumn([](int, int i) { return bayer_column<kTaps>(i); });
  static constexpr auto kAllWords = shuffles<8>(all_words);
  constexpr bool kIsTwice = kBayerColumns<kTaps> == 4;
  // Each halved weight is used twice, once rounded down and once rounded up.
  const __m256i down = kIsTwice ? _mm256_set1_epi64x(static_cast<int64_t>(0xFF00FF00'00FF00FF))
                                : _mm256_set1_epi16(0x00FF);
  const __m256i weights = load_weights<kSlots<kTaps>>(blocks, block, pair);
  const __m256i cols = lattice_cols<kTaps>(weights, down);
  const __m256i other_cols = lattice_cols<kTaps>(weights, _mm256_slli_epi16(down, 8));
  const __m256i rows[2] = {lattice_rows<kTaps, 0>(weights), lattice_rows<kTaps, 8>(weights)};
  __m256i halves[2] = {};
#pragma GCC unroll 9
  for (int row = 0; row < kTaps + 2; ++row) {
    const uint8_t* const first = plane.data + (row - 1) * plane.stride_bytes - 1;
    const auto load = kIsTwice ? load_8 : load_16;
    const __m256i samples = centred(
        kByColumn(_mm256_set_m128i(load(first + place[pair + kPairs]), load(first + place[pair]))));
    const __m256i weight = kAllWords[row % 8](rows[row / 8]);
    __m256i& sums = halves[row % 2];
    sums = _mm256_add_epi32(sums, _mm256_madd_epi16(_mm256_maddubs_epi16(cols, samples), weight));
    if constexpr (!kIsTwice) {
      const __m256i other = _mm256_maddubs_epi16(other_cols, samples);
      sums = _mm256_add_epi32(sums, _mm256_madd_epi16(other, weight));
    }
  }
  return _mm256_hadd_epi32(halves[0], halves[1]);
}

/// The rounded mean from sums of centred samples, whose weights sum to 2^bits.
inline __m256i mean_of(__m256i sums, int bits) {
  return _mm256_srai_epi32(_mm256_add_epi32(sums, _mm256_set1_epi32(1 << (bits - 1))), bits);
}

/// Selects red, green and blue from the four sums of each pixel. The selection depends on whether
/// the first row of the box is even or odd in the frame; the columns are always aligned to the
/// frame.
__m256i colours_of(const SumsByKind& sums, __m256i first_rows, RedPixel red) {
  constexpr int kRedBits = 2 * (RemapTable::kWeightBits + 1);
  const int red_col = red.col == 0 ? 1 : 0;
  // The sums start in the row above the box.
  const __m256i parity = _mm256_xor_si256(first_rows, _mm256_set1_epi32(1 + red.row));
  const __m256i is_swapped = _mm256_slli_epi32(parity, 31);
  const auto chosen = [&](int first, int swapped) __attribute__((always_inline)) {
    return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(sums.kinds[first]),
                                                _mm256_castsi256_ps(sums.kinds[swapped]),
                                                _mm256_castsi256_ps(is_swapped)));
  };
  const int blue_col = 1 - red_col;
  const __m256i green =
      _mm256_add_epi32(chosen(blue_col, 2 + blue_col), chosen(2 + red_col, red_col));
  return to_bytes(mean_of(chosen(red_col, 2 + red_col), kRedBits), mean_of(green, kRedBits + 1),
                  mean_of(chosen(2 + blue_col, blue_col), kRedBits));
}

template <int kTaps, int kParts>
void remap_blocks(const ImageView& image, const RemapBlocks& blocks, int8_t* planes) {
  const ImagePlane& plane = image.planes[0];
  const RedPixel red = red_of(image.format);
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    __m256i sums[kPairs] = {};
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          const Distances place(load_positions(blocks.first_row, part), plane.stride_bytes,
                                load_positions(blocks.first_col, part));
          prefetch_below<kTaps, 1>(plane.data + plane.stride_bytes + place[0], plane.stride_bytes);
          for (int pair = 0; pair < kPairs; ++pair) {
            sums[pair] =
                _mm256_add_epi32(sums[pair], lattice_sums<kTaps>(plane, place, blocks, part, pair));
          }
        });
    // The first rows of all parts have the same parity.
    const __m256i first_rows = load_positions(blocks.first_row, kParts * block);
    store_block(colours_of(SumsByKind(sums), first_rows, red),
                planes + kPixels * blocks.index[block]);
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
