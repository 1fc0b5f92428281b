// Computes the sums of a strip, tile by tile, with dot products by element. The source file of each
// instruction set includes it inside an anonymous namespace, after selecting that set and defining
// a struct `Isa` with
//   kInputOffset                   subtracted from each input byte before the product
//   Input, input(bytes)            sixteen input bytes, ready for dot()
//   dot<lane>(sum, weights, input) four sums, each with four products of one word of the input
//
// A tile has a few pixels and all channels of a group; its sums stay in registers. An instruction
// takes a word (four bytes of input) from a register of four words, so each register of input is
// loaded once and used for all channels, and each register of weights for all pixels.

constexpr int kBytesPerWord = 4;
constexpr int kRegisterLanes = 4;
constexpr int kBytesPerRegister = kBytesPerWord * kRegisterLanes;

/// Loads kWords words. The bytes after them are 0.
template <int kWords>
inline uint8x16_t load_words(const uint8_t* line) {
  if constexpr (kWords == 4) {
    return vld1q_u8(line);
  } else if constexpr (kWords == 2) {
    return vcombine_u8(vld1_u8(line), vdup_n_u8(0));
  } else {
    uint32_t word = 0;
    std::memcpy(&word, line, sizeof(word));
    return vreinterpretq_u8_u32(vsetq_lane_u32(word, vdupq_n_u32(0), 0));
  }
}

/// The sums of kPixels pixels and kRegisters * 4 channels.
template <int kRegisters, int kPixels>
using TileSums = int32x4_t[kPixels][kRegisters];

/// Loads two registers of weights and moves on to the next.
[[gnu::always_inline]] inline int8x16x2_t next_weights(const int8_t*& weights) {
  const int8x16x2_t pair = vld1q_s8_x2(weights);
  weights += 2 * kBytesPerRegister;
  // Otherwise the compiler loads the weights of many words first and has no registers for the sums.
  asm("" : "+r"(weights));
  return pair;
}

/// Adds the products of the words [kWord, kWords) of the input.
template <int kRegisters, int kPixels, int kWords, int kWord = 0>
[[gnu::always_inline]] inline void add_words(const Isa::Input* inputs, const int8_t*& weights,
                                             TileSums<kRegisters, kPixels>& sums) {
#pragma GCC unroll 4
  for (int r = 0; r < kRegisters; r += 2) {
    const int8x16x2_t factors = next_weights(weights);
#pragma GCC unroll 16
    for (int p = 0; p < kPixels; ++p) {
      sums[p][r] = Isa::dot<kWord>(sums[p][r], factors.val[0], inputs[p]);
      sums[p][r + 1] = Isa::dot<kWord>(sums[p][r + 1], factors.val[1], inputs[p]);
    }
  }
  if constexpr (kWord + 1 < kWords) {
    add_words<kRegisters, kPixels, kWords, kWord + 1>(inputs, weights, sums);
  }
}

/// Loads kWords words of each pixel and adds their products.
template <int kRegisters, int kPixels, int kWords>
[[gnu::always_inline]] inline void add_input(const uint8_t*& line, std::ptrdiff_t pixel_step,
                                             const int8_t*& weights,
                                             TileSums<kRegisters, kPixels>& sums) {
  Isa::Input inputs[kPixels];
#pragma GCC unroll 16
  for (int p = 0; p < kPixels; ++p) {
    inputs[p] = Isa::input(load_words<kWords>(line + p * pixel_step));
  }
  line += kBytesPerWord * kWords;
  add_words<kRegisters, kPixels, kWords>(inputs, weights, sums);
}

/// Computes the tile of kPixels pixels from pixel `first` on.
template <int kRegisters, int kPixels>
[[gnu::always_inline]] inline void sum_tile(const KernelStrip& strip, int first) {
  const std::ptrdiff_t step = strip.pixel_step;
  TileSums<kRegisters, kPixels> sums;
#pragma GCC unroll 8
  for (int r = 0; r < kRegisters; ++r) {
    const int32x4_t start = vld1q_s32(strip.start + kRegisterLanes * r);
#pragma GCC unroll 16
    for (int p = 0; p < kPixels; ++p) sums[p][r] = start;
  }
  const int8_t* weights = strip.weights;
  for (int row = 0; row < strip.rows; ++row) {
    const uint8_t* line = strip.lines[row] + first * step;
    for (int left = strip.words / 4; left > 0; --left) {
      add_input<kRegisters, kPixels, 4>(line, step, weights, sums);
    }
    if ((strip.words & 2) != 0) add_input<kRegisters, kPixels, 2>(line, step, weights, sums);
    if ((strip.words & 1) != 0) add_input<kRegisters, kPixels, 1>(line, step, weights, sums);
  }
  int32_t* to = strip.sums + first * strip.sums_step;
  const std::ptrdiff_t sums_step = strip.sums_step;
#pragma GCC unroll 16
  for (int p = 0; p < kPixels; ++p, to += sums_step) {
#pragma GCC unroll 8
    for (int r = 0; r < kRegisters; ++r) vst1q_s32(to + kRegisterLanes * r, sums[p][r]);
  }
}

/// Computes the pixels from `first` on: in tiles of kPixels, then of half as many, and so on.
template <int kRegisters, int kPixels>
[[gnu::always_inline]] inline void sum_from(const KernelStrip& strip, int first) {
  for (; first + kPixels <= strip.pixels; first += kPixels) {
    sum_tile<kRegisters, kPixels>(strip, first);
  }
  if constexpr (kPixels > 1) {
    if (first < strip.pixels) sum_from<kRegisters, kPixels / 2>(strip, first);
  }
}

template <int kRegisters, int kPixels>
void sum_strip(const KernelStrip& strip) {
  sum_from<kRegisters, kPixels>(strip, 0);
}

/// The kernels for groups of 8, 16 and 24 channels. The sums of a tile and its input fill the 32
/// registers almost.
constexpr KernelSet neon_kernels(const char* name) {
  return {.name = name,
          .lanes = 8,
          .kernels = {{},
                      {sum_strip<2, 10>, nullptr},
                      {sum_strip<4, 6>, nullptr},
                      {sum_strip<6, 4>, nullptr}},
          .input_offset = Isa::kInputOffset};
}
