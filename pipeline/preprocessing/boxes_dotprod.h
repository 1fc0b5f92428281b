// Box sums for formats with three channels at each pixel. Include it after blocks_dotprod.h.

/// Offsets in bytes of the boxes of eight pixels, from the first sample of a plane.
class Offsets {
 public:
  Offsets(uint16x8_t rows, std::ptrdiff_t stride_bytes, uint16x8_t bytes_in_row) {
    const auto stride = static_cast<uint32_t>(stride_bytes);
    vst1q_u32(bytes_, vmlaq_n_u32(vmovl_u16(vget_low_u16(bytes_in_row)),
                                  vmovl_u16(vget_low_u16(rows)), stride));
    vst1q_u32(bytes_ + kPixels / 2,
              vmlaq_n_u32(vmovl_high_u16(bytes_in_row), vmovl_high_u16(rows), stride));
  }

  size_t operator[](int pixel) const { return bytes_[pixel]; }

 private:
  alignas(16) uint32_t bytes_[kPixels];
};

/// First rows and columns of the boxes of a part of a block.
struct Corners {
  uint16x8_t rows;
  uint16x8_t cols;

  Corners(const RemapBlocks& blocks, size_t part)
      : rows(vld1q_u16(blocks.first_row.data() + kPixels * part)),
        cols(vld1q_u16(blocks.first_col.data() + kPixels * part)) {}
};

/// The weights of a pixel's columns, each four of them in all words of a register, and those of its
/// rows, one in each word.
template <int kTaps>
struct BoxWeights {
  uint8x16_t cols[2];
  uint32x4_t rows[2];

  template <int kPixel>
  static BoxWeights of(const RemapBlocks& blocks, size_t part) {
    constexpr int kSlots = RemapBlocks::slots(kTaps);
    constexpr int kHalf = kPixel / (kPixels / 2);
    constexpr int kPair = kPixel % (kPixels / 2);
    const uint8_t* const first = blocks.weights.data() + 2 * kSlots * kPixels * part;
    if constexpr (kSlots == 4) {  // a register holds the weights of a pair
      return of_register<8 * kHalf, 8 * kHalf + 4>(vld1q_u8(first + 16 * kPair));
    } else {
      return of_register<0, 8>(vld1q_u8(first + 16 * (2 * kPair + kHalf)));
    }
  }

 private:
  /// kCols and kRows are positions in bytes.
  template <int kCols, int kRows>
  static BoxWeights of_register(uint8x16_t weights) {
    constexpr int kMore = RemapBlocks::slots(kTaps) - 4;
    const uint32x4_t words = vreinterpretq_u32_u8(weights);
    return {{vreinterpretq_u8_u32(vdupq_laneq_u32(words, kCols / 4)),
             vreinterpretq_u8_u32(vdupq_laneq_u32(words, (kCols + kMore) / 4))},
            {words_of<kRows>(weights), words_of<kRows + kMore>(weights)}};
  }
  /// Four bytes, from position kFirst on, as words.
  template <int kFirst>
  static uint32x4_t words_of(uint8x16_t bytes) {
    static constexpr Shuffle kAsWords([](int i) { return i % 4 == 0 ? kFirst + i / 4 : kNone; });
    return vreinterpretq_u32_u8(kAsWords(bytes));
  }
};

/// Adds to `sums` the weighted samples of the boxes of a part of a block. The weights of a pixel
/// sum to 2^16, over all its parts. samples.at<row, group>(pixel) returns the samples of four
/// columns for each channel.
template <int kTaps, typename Samples>
[[gnu::always_inline]] inline void add_boxes(const Samples& samples, const RemapBlocks& blocks,
                                             size_t part, Sums (&sums)[kPixels]) {
  repeat<kPixels>([&](auto i) __attribute__((always_inline)) {
    constexpr int kPixel = i() / 2 + i() % 2 * (kPixels / 2);  // the order of the weights
    const auto weights = BoxWeights<kTaps>::template of<kPixel>(blocks, part);
    repeat<kTaps>([&](auto row) __attribute__((always_inline)) {
      Sums line = vdotq_u32(vdupq_n_u32(0), samples.template at<row(), 0>(kPixel), weights.cols[0]);
      if constexpr (RemapBlocks::slots(kTaps) == 8) {
        line = vdotq_u32(line, samples.template at<row(), 1>(kPixel), weights.cols[1]);
      }
      sums[kPixel] = add_line<row()>(sums[kPixel], line, weights.rows);
    });
  });
}
