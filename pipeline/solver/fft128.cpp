#include "pipeline/solver/fft128.h"

#include <cmath>
#include <numbers>

#include "common/target_clones.h"

namespace bevloc {
namespace {

struct Twiddle {
  float re;
  float im;
};

/// exp(-2 pi i j / 128) for half a turn.
const auto kTwiddles = [] {
  std::array<Twiddle, kFftSize / 2> twiddles{};
  for (int j = 0; j < kFftSize / 2; ++j) {
    const double angle = -2.0 * std::numbers::pi * j / kFftSize;
    twiddles[j] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  return twiddles;
}();

/// Cooley and Tukey's radix-2 butterflies; the lanes do the same work on sixteen signals.
BEVLOC_TARGET_CLONES void butterflies(float* re, float* im, const Twiddle* twiddles) {
  for (int half = 1; half < kFftSize; half *= 2) {
    const int twiddle_step = kFftSize / (2 * half);
    for (int begin = 0; begin < kFftSize; begin += 2 * half) {
      for (int j = 0; j < half; ++j) {
        const Twiddle w = twiddles[j * twiddle_step];
        const int a = (begin + j) * kLanes;
        const int b = a + half * kLanes;
        const Lanes turned_re = w.re * lanes(re + b) - w.im * lanes(im + b);
        const Lanes turned_im = w.re * lanes(im + b) + w.im * lanes(re + b);
        lanes(re + b) = lanes(re + a) - turned_re;
        lanes(im + b) = lanes(im + a) - turned_im;
        lanes(re + a) += turned_re;
        lanes(im + a) += turned_im;
      }
    }
  }
}

}  // namespace

void fft128(FftTile& tile) {
  butterflies(tile.re.data(), tile.im.data(), kTwiddles.data());
}

}  // namespace bevloc
