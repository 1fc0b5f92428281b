#include "pipeline/network/kernels/direct_convolution.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/pipeline/network/kernels/random_layer.h"

namespace bevloc::nn {
namespace {

using test::kF32;
using test::kS8;
using test::kU8;
using test::LayerCase;
using test::random_bytes;
using test::RandomLayer;

class DirectConvolutionTest : public testing::TestWithParam<LayerCase> {};

TEST_P(DirectConvolutionTest, EveryKernelSetRoundsTheExactSum) {
  const RandomLayer layer(GetParam());
  // Rounding changes a value by at most half a step. A float has seven digits.
  const double bound = GetParam().output_type == kF32 ? 1.0e-4 : 0.5001;
  for (const KernelSet* kernels : kernel_sets()) {
    ASSERT_TRUE(layer.can_run(*kernels)) << kernels->name;
    EXPECT_LE(layer.largest_error(layer.run(*kernels)), bound) << kernels->name;
  }
}

TEST_P(DirectConvolutionTest, AllKernelSetsAgreeToTheBit) {
  const RandomLayer layer(GetParam(), 2);
  const auto plain = layer.run(*kernel_sets().back());
  for (const KernelSet* kernels : kernel_sets()) {
    EXPECT_EQ(layer.run(*kernels), plain) << kernels->name;
  }
}

TEST_P(DirectConvolutionTest, PiecesMakeTheWhole) {
  const RandomLayer layer(GetParam(), 3);
  const KernelSet& kernels = *kernel_sets().front();
  const auto whole = layer.run(kernels);
  EXPECT_EQ(layer.run(kernels, 1), whole);
  EXPECT_EQ(layer.run(kernels, 3), whole);
}

INSTANTIATE_TEST_SUITE_P(
    Layers, DirectConvolutionTest,
    testing::Values(
        LayerCase{.what = "Plain", .input = {2, 16, 9, 11}, .channels = 16},
        LayerCase{.what = "OneVectorAndAHalf", .input = {1, 8, 5, 50}, .channels = 24},
        LayerCase{.what = "TwoVectorsAndAHalf", .input = {1, 4, 5, 21}, .channels = 40},
        LayerCase{.what = "ThreeVectors", .input = {1, 12, 6, 20}, .channels = 48},
        LayerCase{.what = "SeveralGroups", .input = {1, 8, 4, 13}, .channels = 136},
        LayerCase{.what = "FewChannels", .input = {1, 4, 6, 7}, .channels = 4},
        LayerCase{.what = "OddChannels", .input = {1, 7, 6, 7}, .channels = 21},
        LayerCase{.what = "OneChannel", .input = {1, 1, 6, 7}, .channels = 1},
        LayerCase{.what = "Stride2", .input = {2, 12, 10, 17}, .channels = 24, .strides = {2, 2}},
        LayerCase{.what = "UnevenPads",
                  .input = {1, 4, 8, 9},
                  .channels = 8,
                  .strides = {2, 1},
                  .pads = {0, 1, 1, 0}},
        LayerCase{.what = "NoPads", .input = {1, 8, 7, 9}, .channels = 8, .pads = {}},
        LayerCase{.what = "OneByOne",
                  .input = {2, 40, 6, 9},
                  .channels = 48,
                  .kernel = {1, 1},
                  .pads = {}},
        LayerCase{.what = "OneByOneStride2",
                  .input = {1, 8, 7, 9},
                  .channels = 8,
                  .kernel = {1, 1},
                  .strides = {2, 2},
                  .pads = {}},
        LayerCase{.what = "FiveByThree",
                  .input = {1, 6, 8, 9},
                  .channels = 8,
                  .kernel = {5, 3},
                  .pads = {2, 1, 2, 1}},
        LayerCase{.what = "SignedInput", .input = {1, 8, 6, 9}, .channels = 16, .input_type = kS8},
        LayerCase{.what = "SignedOneByOne",
                  .input = {1, 8, 6, 9},
                  .channels = 16,
                  .kernel = {1, 1},
                  .pads = {},
                  .input_type = kS8},
        LayerCase{.what = "Planes",
                  .input = {2, 3, 8, 33},
                  .channels = 12,
                  .strides = {2, 2},
                  .input_type = kS8,
                  .order = ChannelOrder::kPlanes},
        LayerCase{.what = "UnsignedPlanes",
                  .input = {1, 2, 8, 9},
                  .channels = 12,
                  .order = ChannelOrder::kPlanes},
        LayerCase{.what = "ToInt8",
                  .input = {1, 8, 6, 9},
                  .channels = 20,
                  .output_type = kS8,
                  .relu = false},
        LayerCase{.what = "ToFloat",
                  .input = {1, 8, 6, 9},
                  .channels = 21,
                  .output_type = kF32,
                  .relu = false},
        LayerCase{
            .what = "FloatAfterRelu", .input = {1, 8, 6, 9}, .channels = 8, .output_type = kF32},
        LayerCase{
            .what = "ResidualOfUint8", .input = {1, 8, 6, 9}, .channels = 20, .residual = kU8},
        LayerCase{.what = "ResidualOfInt8",
                  .input = {1, 8, 6, 9},
                  .channels = 16,
                  .output_type = kS8,
                  .residual = kS8,
                  .relu = false},
        LayerCase{.what = "Uint8ToFloat",
                  .input = {1, 8, 6, 9},
                  .channels = 16,
                  .output_type = kF32,
                  .residual = kU8,
                  .relu = false},
        LayerCase{.what = "FloatToFloat",
                  .input = {1, 8, 6, 9},
                  .channels = 13,
                  .output_type = kF32,
                  .residual = kF32,
                  .relu = false}),
    [](const auto& layer) { return layer.param.what; });

TEST(RandomLayerTest, AnElementThatIsNotFiniteIsAnInfiniteError) {
  const RandomLayer layer({.what = "", .input = {1, 8, 6, 9}, .channels = 8, .output_type = kF32});
  auto elements = layer.run(*kernel_sets().back());
  EXPECT_LE(layer.largest_error(elements), 1.0e-4);
  std::fill_n(elements.begin(), sizeof(float), std::byte{0xFF});  // not a number
  EXPECT_GT(layer.largest_error(elements), 1.0e9);
}

TEST(DirectConvolution, KernelSetsAgreeForEveryWidth) {
  for (const int64_t channels : {8, 16, 24}) {
    for (int64_t width = 1; width <= 25; ++width) {
      const RandomLayer layer({.what = "", .input = {1, 4, 2, width}, .channels = channels});
      const auto plain = layer.run(*kernel_sets().back());
      for (const KernelSet* kernels : kernel_sets()) {
        EXPECT_EQ(layer.run(*kernels), plain) << kernels->name << ", width " << width;
      }
    }
  }
}

TEST(DirectConvolution, ResidualMayBeTheOutputsOwnMemory) {
  const LayerCase c{.what = "", .input = {1, 8, 6, 9}, .channels = 20, .residual = kU8};
  const Value input{c.input, kU8, 0.02F};
  const Value output{{1, 20, 6, 9}, kU8, 0.1F};
  RandomLayer layer(c);
  std::mt19937 random(4);
  const auto elements = random_bytes(1 * 8 * 6 * 9, random);
  const auto before = random_bytes(1 * 20 * 6 * 9, random);
  const DirectConvolution convolution(layer.step(), input, output, &output, *kernel_sets().front());
  std::vector<std::byte> scratch(convolution.scratch_bytes());
  auto apart = before;
  convolution.run(elements.data(), before.data(), apart.data(), 0, 6, scratch.data());
  auto in_place = before;
  convolution.run(elements.data(), in_place.data(), in_place.data(), 0, 6, scratch.data());
  EXPECT_NE(apart, before);
  EXPECT_EQ(in_place, apart);
}

TEST(DirectConvolution, LeavesToOthersWhatItCannotDo) {
  const LayerCase c{.what = "", .input = {1, 8, 6, 9}, .channels = 8};
  const Value input{c.input, kU8, 0.02F};
  for (const KernelSet* kernels : kernel_sets()) {
    const auto can_run = [&](auto change) {
      RandomLayer layer(c);
      change(layer.step());
      return DirectConvolution::can_run(layer.step(), input, *kernels);
    };
    EXPECT_TRUE(can_run([](ConvStep&) {}));
    EXPECT_FALSE(can_run([](ConvStep& step) { step.groups = 2; }));
    EXPECT_FALSE(can_run([](ConvStep& step) { step.dilations = {1, 2}; }));
    EXPECT_FALSE(can_run([](ConvStep& step) { step.weights.type = kF32; }));
    const auto with_weight = [&](int8_t weight) {
      return can_run([weight](ConvStep& step) { step.weights.bytes[5] = std::byte(weight); });
    };
    EXPECT_TRUE(with_weight(64)) << kernels->name;
    EXPECT_TRUE(with_weight(-64)) << kernels->name;
    EXPECT_EQ(with_weight(127), kernels->largest_weight == 127) << kernels->name;
    EXPECT_EQ(with_weight(-65), kernels->largest_weight == 127) << kernels->name;
    const Value real{c.input, kF32, 1.0F};
    RandomLayer layer(c);
    EXPECT_FALSE(DirectConvolution::can_run(layer.step(), real, *kernels));
  }
}

/// All inputs are 255 and all weights as large as allowed, so that narrower sums would saturate.
TEST(DirectConvolution, LargestSumsAreExact) {
  const Value input{{1, 64, 3, 40}, kU8, 1.0F};
  const Value output{{1, 16, 3, 40}, kF32, 1.0F};
  const std::vector<std::byte> elements(64 * 3 * 40, std::byte{255});
  for (const KernelSet* kernels : kernel_sets()) {
    for (const int sign : {-1, 1}) {
      ConvStep step;
      step.weights = {kS8, {16, 64, 3, 3}, {}};
      step.weights.bytes.assign(16 * 64 * 9, std::byte(sign * kernels->largest_weight));
      step.weight_scale.assign(16, 1.0F);
      step.pads = {1, 1, 1, 1};
      const DirectConvolution convolution(step, input, output, nullptr, *kernels);
      std::vector<float> sums(16 * 3 * 40);
      std::vector<std::byte> scratch(convolution.scratch_bytes());
      convolution.run(elements.data(), nullptr, std::as_writable_bytes(std::span(sums)).data(), 0,
                      3, scratch.data());
      // A pixel of the middle row, away from the borders, sums nine cells of 64 channels.
      const auto wanted = static_cast<float>(sign * 255 * kernels->largest_weight * 9 * 64);
      EXPECT_EQ(sums[(40 + 20) * 16], wanted) << kernels->name;
    }
  }
}

TEST(KernelSets, TheCapIsKept) {
  EXPECT_EQ(&kernel_set(IsaCap::kBest), kernel_sets().front());
#ifdef __x86_64__
  const std::string name = kernel_set(IsaCap::kAvx2).name;
  EXPECT_TRUE(name == "AVX2" || name == "plain") << name;
#endif
  EXPECT_STREQ(kernel_sets().back()->name, "plain");
}

}  // namespace
}  // namespace bevloc::nn
