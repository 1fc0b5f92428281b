// Strip kernels for arm64 with the dot product of signed bytes (FEAT_DotProd, Armv8.2). An
// instruction multiplies one word of input by the weights of four channels. It takes the word from
// a register that holds four.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __aarch64__
#include <cstring>

#include <arm_neon.h>

#pragma GCC target("arch=armv8.2-a+dotprod")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/strip_tiles_neon.h"

/// The instruction takes signed bytes. An XOR with 128 subtracts 128 from an unsigned byte.
constexpr int kOffset = 128;

/// The sums of kPixels pixels and kRegisters * kRegisterLanes channels.
template <int kRegisters, int kPixels>
using TileSums = int32x4_t[kPixels][kRegisters];

/// Loads kWords words.
template <int kWords>
int8x16_t load_input(const uint8_t* line) {
  uint8x16_t bytes;
  if constexpr (kWords == 4) {
    bytes = vld1q_u8(line);
  } else {
    bytes = vcombine_u8(load_half<kWords>(line), vdup_n_u8(0));
  }
  return vreinterpretq_s8_u8(veorq_u8(bytes, vdupq_n_u8(kOffset)));
}

/// Adds the products of the words [kWord, kWords) of the input.
template <int kRegisters, int kPixels, int kWords, int kWord = 0>
[[gnu::always_inline]] inline void add_words(const int8x16_t* inputs, const int8_t*& weights,
                                             TileSums<kRegisters, kPixels>& sums) {
#pragma GCC unroll 4
  for (int r = 0; r < kRegisters; r += 2) {
    const int8x16x2_t factors = next_weights(weights);
#pragma GCC unroll 16
    for (int p = 0; p < kPixels; ++p) {
      sums[p][r] = vdotq_laneq_s32(sums[p][r], factors.val[0], inputs[p], kWord);
      sums[p][r + 1] = vdotq_laneq_s32(sums[p][r + 1], factors.val[1], inputs[p], kWord);
    }
  }
  if constexpr (kWord + 1 < kWords) {
    add_words<kRegisters, kPixels, kWords, kWord + 1>(inputs, weights, sums);
  }
}

struct DotProduct {
  static constexpr int kStepWords = 1;
  static constexpr int kInputOffset = kOffset;

  template <int kRegisters, int kPixels>
  [[gnu::always_inline]] static void sum_tile(const KernelStrip& strip, int first) {
    const std::ptrdiff_t pixel_step = strip.pixel_step;
    TileSums<kRegisters, kPixels> sums;
#pragma GCC unroll 8
    for (int r = 0; r < kRegisters; ++r) {
      const int32x4_t start = vld1q_s32(strip.start + kRegisterLanes * r);
#pragma GCC unroll 16
      for (int p = 0; p < kPixels; ++p) sums[p][r] = start;
    }
    const int8_t* weights = strip.weights;
    for (int row = 0; row < strip.rows; ++row) {
      for_words(
          strip.lines[row] + first * pixel_step,
          strip.words, [&]<int kWords>(const uint8_t* line) __attribute__((always_inline)) {
            int8x16_t inputs[kPixels];
#pragma GCC unroll 16
            for (int p = 0; p < kPixels; ++p) inputs[p] = load_input<kWords>(line + p * pixel_step);
            add_words<kRegisters, kPixels, kWords>(inputs, weights, sums);
          });
    }
    int32_t* to = strip.sums + first * strip.sums_step;
#pragma GCC unroll 16
    for (int p = 0; p < kPixels; ++p, to += strip.sums_step) {
#pragma GCC unroll 8
      for (int r = 0; r < kRegisters; ++r) vst1q_s32(to + kRegisterLanes * r, sums[p][r]);
    }
  }
};

}  // namespace

const KernelSet kDotProductKernels = neon_kernels<DotProduct>("NEON-DotProd");

}  // namespace bevloc::nn
#endif
