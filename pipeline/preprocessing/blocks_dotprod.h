// Parts of the arm64 kernels. Include it inside an anonymous namespace, after
// "#pragma GCC target" has selected dot products, and after block_shapes.h.
//
// The kernels compute one pixel of a block after the other. A shuffle brings the samples of a row
// into the order of the weights, so that one instruction sums four products of each channel.

constexpr int kNone = -1;

/// Byte i of the result is byte source(i) of the argument, or 0 for kNone.
struct Shuffle {
  alignas(16) uint8_t bytes[16];

  template <typename Source>
  explicit constexpr Shuffle(const Source& source) : bytes() {
    for (int i = 0; i < 16; ++i) bytes[i] = static_cast<uint8_t>(source(i));
  }
  uint8x16_t operator()(uint8x16_t from) const { return vqtbl1q_u8(from, vld1q_u8(bytes)); }
};

/// Position of a pixel's box in a block of RemapBlocks.
struct Corner {
  int row;
  int col;

  Corner(const RemapBlocks& blocks, size_t block, int pixel)
      : row(blocks.first_row[kPixels * block + pixel]),
        col(blocks.first_col[kPixels * block + pixel]) {}
};

/// The weights of a pixel: of its columns, then of its rows, kSlots each. Bytes after them are 0.
template <int kSlots>
uint8x16_t load_weights(const RemapBlocks& blocks, size_t block, int pixel) {
  const int position = pixel < kPixels / 2 ? 2 * pixel : 2 * pixel - kPixels + 1;
  const uint8_t* const first = blocks.weights.data() + 2 * kSlots * (kPixels * block + position);
  if constexpr (kSlots == 4) return vcombine_u8(vld1_u8(first), vdup_n_u8(0));
  return vld1q_u8(first);
}

/// Four sums of a pixel, one for each kind of sample.
using Sums = uint32x4_t;

/// Computes sums + line * rows[kRow].
template <int kRow>
[[gnu::always_inline]] inline Sums add_line(Sums sums, Sums line, const uint32x4_t* rows) {
  return vmlaq_laneq_u32(sums, line, rows[kRow / 4], kRow % 4);
}

/// Calls body with std::integral_constant 0, 1, ..., kCount - 1.
template <int kCount, typename Body>
[[gnu::always_inline]] inline void repeat(const Body& body) {
  [&body]<int... kIndex>(std::integer_sequence<int, kIndex...>) __attribute__((always_inline)) {
    (body(std::integral_constant<int, kIndex>()), ...);
  }
  (std::make_integer_sequence<int, kCount>());
}

/// The sums of each kind for the eight pixels of a block.
struct SumsByKind {
  struct Eight {
    uint32x4_t low;
    uint32x4_t high;
  };
  Eight kinds[4];

  explicit SumsByKind(const Sums (&pixels)[kPixels]) {
    for (int half = 0; half < 2; ++half) {
      const Sums* const p = pixels + kPixels / 2 * half;
      const uint64x2_t pairs[4] = {as_64(vzip1q_u32(p[0], p[1])), as_64(vzip1q_u32(p[2], p[3])),
                                   as_64(vzip2q_u32(p[0], p[1])), as_64(vzip2q_u32(p[2], p[3]))};
      for (int kind = 0; kind < 4; ++kind) {
        const uint64x2_t first = pairs[kind / 2 * 2];
        const uint64x2_t second = pairs[kind / 2 * 2 + 1];
        (half == 0 ? kinds[kind].low : kinds[kind].high) = vreinterpretq_u32_u64(
            kind % 2 == 0 ? vzip1q_u64(first, second) : vzip2q_u64(first, second));
      }
    }
  }

 private:
  static uint64x2_t as_64(uint32x4_t lanes) { return vreinterpretq_u64_u32(lanes); }
};

/// Writes eight pixels of one plane: the samples minus 128.
inline void store_pixels(uint8x8_t samples, int8_t* plane) {
  vst1_s8(plane, vreinterpret_s8_u8(veor_u8(samples, vdup_n_u8(128))));
}
