#include "pipeline/solver/reference/lanes_fft.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

class LanesFftTest : public testing::TestWithParam<int> {};

TEST_P(LanesFftTest, AgreesWithTheSumThatDefinesIt) {
  const int length = GetParam();
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<std::vector<std::complex<double>>> signals(kLanes);
  FftTile tile(length);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int n = 0; n < length; ++n) {
      const float re = normal(random);
      const float im = normal(random);
      signals[lane].emplace_back(re, im);
      tile.re[n * kLanes + lane] = re;
      tile.im[n * kLanes + lane] = im;
    }
  }
  LanesFft fft(length);
  fft.transform(tile);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int k = 0; k < length; ++k) {
      std::complex<double> expected = 0.0;
      for (int n = 0; n < length; ++n) {
        const double angle = -2.0 * std::numbers::pi * (k * n % length) / length;
        expected += signals[lane][n] * std::polar(1.0, angle);
      }
      ASSERT_NEAR(tile.re[k * kLanes + lane], expected.real(), 1e-4) << k;
      ASSERT_NEAR(tile.im[k * kLanes + lane], expected.imag(), 1e-4) << k;
    }
  }
}

TEST(LanesFft, DoesNotReadASecondHalfOfZeros) {
  for (const int length : {8, 20, 64, 128}) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    FftTile tile(length);
    for (int i = 0; i < length / 2 * kLanes; ++i) {
      tile.re[i] = normal(random);
      tile.im[i] = normal(random);
    }
    FftTile with_garbage = tile;
    for (int i = length / 2 * kLanes; i < length * kLanes; ++i) with_garbage.re[i] = 1e9F;
    LanesFft fft(length);
    fft.transform(tile);
    fft.transform_half(with_garbage);
    for (int i = 0; i < length * kLanes; ++i) {
      EXPECT_NEAR(with_garbage.re[i], tile.re[i], 1e-5F);
      EXPECT_NEAR(with_garbage.im[i], tile.im[i], 1e-5F);
    }
  }
}

TEST(LanesFft, WritesToOtherMemoryWithAStride) {
  constexpr int kLength = 40;
  constexpr int kStride = 3 * kLanes;
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  FftTile tile(kLength);
  for (float& value : tile.re) value = normal(random);
  for (float& value : tile.im) value = normal(random);
  FftTile again = tile;
  LanesFft fft(kLength);
  fft.transform(tile);
  LaneBuffer out(static_cast<size_t>(kLength) * kStride);
  fft.transform_to(again, out.data(), out.data() + kLanes, kStride);
  for (int k = 0; k < kLength; ++k) {
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_EQ(out[k * kStride + lane], tile.re[k * kLanes + lane]);
      EXPECT_EQ(out[k * kStride + kLanes + lane], tile.im[k * kLanes + lane]);
      EXPECT_EQ(out[k * kStride + 2 * kLanes + lane], 0.0F);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lengths, LanesFftTest,
                         testing::Values(1, 2, 4, 5, 8, 10, 25, 50, 64, 100, 128, 200, 400, 512));

TEST(LanesFft, SupportsLengthsOfItsRadices) {
  EXPECT_TRUE(LanesFft::supports(1));
  EXPECT_TRUE(LanesFft::supports(400));
  for (const int length : {-4, 0, 3, 7, 90}) EXPECT_FALSE(LanesFft::supports(length)) << length;
  EXPECT_EQ(LanesFft::power_of_two_from(64), 64);
  EXPECT_EQ(LanesFft::power_of_two_from(65), 128);
}

}  // namespace
}  // namespace bevloc
