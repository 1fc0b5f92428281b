#include "pipeline/solver/fft128.h"

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

TEST(Fft128Test, AgreesWithTheSumThatDefinesIt) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::array<std::array<std::complex<double>, kFftSize>, kLanes> signals;
  const auto tile = std::make_unique<FftTile>();
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int n = 0; n < kFftSize; ++n) {
      const float re = normal(random);
      const float im = normal(random);
      signals[lane][n] = {re, im};
      tile->re[fft_slot(n) * kLanes + lane] = re;
      tile->im[fft_slot(n) * kLanes + lane] = im;
    }
  }
  fft128(*tile);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int k = 0; k < kFftSize; ++k) {
      std::complex<double> expected = 0.0;
      for (int n = 0; n < kFftSize; ++n) {
        expected += signals[lane][n] * std::polar(1.0, -2.0 * std::numbers::pi * k * n / kFftSize);
      }
      EXPECT_NEAR(tile->re[k * kLanes + lane], expected.real(), 1e-4);
      EXPECT_NEAR(tile->im[k * kLanes + lane], expected.imag(), 1e-4);
    }
  }
}

}  // namespace
}  // namespace bevloc
