// Strip kernels for arm64 with matrix products of unsigned and signed bytes (FEAT_I8MM, Armv8.6).
// An instruction multiplies eight bytes of input of two pixels by the weights of two channels,
// which is twice as much as a dot product does.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __aarch64__
#include <algorithm>
#include <cstring>

#include <arm_neon.h>

#pragma GCC target("arch=armv8.2-a+i8mm")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/strip_tiles_neon.h"

constexpr int kStepBytes = 8;

/// Pairs of pixels in a tile. If their number is odd, the last pair has the last pixel twice.
template <int kPixels>
constexpr int kPairs = (kPixels + 1) / 2;

/// sums[pair][c] holds four sums: of the pair's first pixel for channels 2c and 2c + 1, then of its
/// second pixel for the same channels.
template <int kRegisters, int kPixels>
using TileSums = int32x4_t[kPairs<kPixels>][2 * kRegisters];

/// Up to four words of two pixels. A step has eight bytes of one, then eight of the other.
struct PairInput {
  uint8x16_t steps[2];
};

template <int kWords>
[[gnu::always_inline]] inline PairInput load_pair(const uint8_t* one, const uint8_t* other) {
  if constexpr (kWords == 4) {
    const uint64x2_t a = vreinterpretq_u64_u8(vld1q_u8(one));
    const uint64x2_t b = vreinterpretq_u64_u8(vld1q_u8(other));
    return {{vreinterpretq_u8_u64(vzip1q_u64(a, b)), vreinterpretq_u8_u64(vzip2q_u64(a, b))}};
  } else {
    return {{vcombine_u8(load_half<kWords>(one), load_half<kWords>(other))}};
  }
}

/// Adds the products of the steps [kStep, kSteps) of the input.
template <int kRegisters, int kPixels, int kSteps, int kStep = 0>
[[gnu::always_inline]] inline void add_steps(const PairInput* inputs, const int8_t*& weights,
                                             TileSums<kRegisters, kPixels>& sums) {
#pragma GCC unroll 8
  for (int c = 0; c < 2 * kRegisters; c += 2) {
    const int8x16x2_t factors = next_weights<2>(weights);
#pragma GCC unroll 8
    for (int pair = 0; pair < kPairs<kPixels>; ++pair) {
      const uint8x16_t input = inputs[pair].steps[kStep];
      sums[pair][c] = vusmmlaq_s32(sums[pair][c], input, factors.val[0]);
      sums[pair][c + 1] = vusmmlaq_s32(sums[pair][c + 1], input, factors.val[1]);
    }
  }
  if constexpr (kStep + 1 < kSteps) {
    add_steps<kRegisters, kPixels, kSteps, kStep + 1>(inputs, weights, sums);
  }
}

struct MatrixProduct {
  static constexpr int kStepWords = kStepBytes / kBytesPerWord;
  static constexpr bool kTakesSigned = false;
  static constexpr int kPixelsTogether = 2;  ///< pixels that one instruction computes

  template <int kRegisters, int kPixels>
  [[gnu::always_inline]] static void sum_tile(const KernelStrip& strip, int first) {
    const std::ptrdiff_t pixel_step = strip.pixel_step;
    TileSums<kRegisters, kPixels> sums;
#pragma GCC unroll 16
    for (int c = 0; c < 2 * kRegisters; ++c) {
      const int32x2_t start = vld1_s32(strip.start + 2 * c);
#pragma GCC unroll 8
      for (auto& pair : sums) pair[c] = vcombine_s32(start, start);
    }
    const int8_t* weights = strip.weights;
    for (int row = 0; row < strip.rows; ++row) {
      for_words(
          strip.lines[row] + first * pixel_step,
          strip.words, [&]<int kWords>(const uint8_t* line) __attribute__((always_inline)) {
            PairInput inputs[kPairs<kPixels>];
#pragma GCC unroll 8
            for (int pair = 0; pair < kPairs<kPixels>; ++pair) {
              inputs[pair] =
                  load_pair<kWords>(line + 2 * pair * pixel_step,
                                    line + std::min(2 * pair + 1, kPixels - 1) * pixel_step);
            }
            add_steps<kRegisters, kPixels, (kWords + 1) / 2>(inputs, weights, sums);
          });
    }
    store<kRegisters, kPixels>(sums, strip, first);
  }

 private:
  template <int kRegisters, int kPixels>
  [[gnu::always_inline]] static void store(const TileSums<kRegisters, kPixels>& sums,
                                           const KernelStrip& strip, int first) {
    int32_t* to = strip.sums + first * strip.sums_step;
#pragma GCC unroll 16
    for (int p = 0; p < kPixels; ++p, to += strip.sums_step) {
#pragma GCC unroll 8
      for (int r = 0; r < kRegisters; ++r) {
        const int64x2_t low = vreinterpretq_s64_s32(sums[p / 2][2 * r]);
        const int64x2_t high = vreinterpretq_s64_s32(sums[p / 2][2 * r + 1]);
        const int64x2_t pixel = p % 2 == 0 ? vzip1q_s64(low, high) : vzip2q_s64(low, high);
        vst1q_s32(to + kRegisterLanes * r, vreinterpretq_s32_s64(pixel));
      }
    }
  }
};

}  // namespace

const KernelSet kI8mmKernels = neon_kernels<MatrixProduct>("NEON-I8MM");

}  // namespace bevloc::nn
#endif
