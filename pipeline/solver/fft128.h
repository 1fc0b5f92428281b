// Sixteen Fourier transforms of 128 points at once.
#pragma once

#include <array>

#include "pipeline/solver/lanes.h"

namespace bevloc {

inline constexpr int kFftSize = 128;

/// Sixteen complex signals side by side; small enough for the first-level cache.
struct FftTile {
  alignas(64) std::array<float, kFftSize * kLanes> re;
  alignas(64) std::array<float, kFftSize * kLanes> im;
};

/// Where sample n has to be put: the transform wants its input in bit-reversed order.
constexpr int fft_slot(int n) {
  int slot = 0;
  for (int bit = 1; bit < kFftSize; bit *= 2) slot = 2 * slot + ((n & bit) != 0 ? 1 : 0);
  return slot;
}

/// X[k] = sum over n of x[n] exp(-2 pi i k n / 128), in place, output in order.
void fft128(FftTile& tile);

}  // namespace bevloc
