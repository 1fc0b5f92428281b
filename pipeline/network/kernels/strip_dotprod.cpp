// Strip kernels for arm64 with the dot product of signed bytes (FEAT_DotProd, Armv8.2). An
// instruction multiplies one word of input by the weights of four channels. It takes the word from
// a register that holds four.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __aarch64__
#include <algorithm>
#include <cstring>

#include <arm_neon.h>

#pragma GCC target("arch=armv8.2-a+dotprod")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/strip_tiles_neon.h"

/// The sums of kPixels pixels and kRegisters * kRegisterLanes channels.
template <int kRegisters, int kPixels>
using TileSums = int32x4_t[kPixels][kRegisters];

/// Loads kWords words.
template <int kWords>
int8x16_t load_input(const uint8_t* line) {
  if constexpr (kWords == 4) {
    return vreinterpretq_s8_u8(vld1q_u8(line));
  } else {
    return vreinterpretq_s8_u8(vcombine_u8(load_half<kWords>(line), vdup_n_u8(0)));
  }
}

/// Adds the products of the words [kWord, kWords) of the input.
template <int kRegisters, int kPixels, int kWords, int kWord = 0>
[[gnu::always_inline]] inline void add_words(const int8x16_t* inputs, const int8_t*& weights,
                                             TileSums<kRegisters, kPixels>& sums) {
  constexpr int kLoaded = kRegisters == 6 ? 3 : 2;
#pragma GCC unroll 2
  for (int first = 0; first < kRegisters; first += kLoaded) {
    const auto factors = next_weights<kLoaded>(weights);
#pragma GCC unroll 16
    for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 3
      for (int r = 0; r < kLoaded; ++r) {
        int32x4_t& sum = sums[p][first + r];
        sum = vdotq_laneq_s32(sum, factors.val[r], inputs[p], kWord);
      }
    }
  }
  if constexpr (kWord + 1 < kWords) {
    add_words<kRegisters, kPixels, kWords, kWord + 1>(inputs, weights, sums);
  }
}

struct DotProduct {
  static constexpr int kStepWords = 1;
  static constexpr bool kTakesSigned = true;
  static constexpr int kPixelsTogether = 1;  ///< pixels that one instruction computes

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
    for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 8
      for (int r = 0; r < kRegisters; ++r) vst1q_s32(to + kRegisterLanes * r, sums[p][r]);
      to += strip.sums_step;
      asm("" : "+r"(to));  // otherwise the compiler computes all addresses before the first store
    }
  }
};

}  // namespace

const KernelSet kDotProductKernels = neon_kernels<DotProduct>("NEON-DotProd");

}  // namespace bevloc::nn
#endif
