#include "pipeline/network/kernels/direct_convolution.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ostream>
#include <random>

#include <gtest/gtest.h>

namespace bevloc::nn {
namespace {

constexpr auto kU8 = ElementType::kUint8;
constexpr auto kS8 = ElementType::kInt8;
constexpr auto kF32 = ElementType::kFloat32;

/// Stands for "no residual".
constexpr auto kNone = ElementType::kInt64;

struct Case {
  const char* what;              ///< name of the test case
  std::array<int64_t, 4> input;  ///< n, c, h, w
  int64_t channels;
  std::array<int64_t, 2> kernel{3, 3};
  std::array<int64_t, 2> strides{1, 1};
  std::array<int64_t, 4> pads{1, 1, 1, 1};
  ElementType input_type = kU8;
  ElementType output_type = kU8;
  ElementType residual = kNone;
  bool relu = true;
  ChannelOrder order = ChannelOrder::kLast;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.what;
}

std::vector<std::byte> random_bytes(size_t count, std::mt19937& random) {
  std::vector<std::byte> bytes(count);
  std::ranges::generate(bytes, [&random] { return static_cast<std::byte>(random() & 0xFFU); });
  return bytes;
}

double element(const std::vector<std::byte>& bytes, ElementType type, size_t i) {
  if (type == kU8) return static_cast<double>(static_cast<uint8_t>(bytes[i]));
  if (type == kS8) return static_cast<double>(static_cast<int8_t>(bytes[i]));
  float value = 0.0F;
  std::memcpy(&value, bytes.data() + i * sizeof(float), sizeof(float));
  return static_cast<double>(value);
}

/// A convolution with random weights and input.
class Layer {
 public:
  explicit Layer(const Case& c, uint32_t seed = 1) : case_(c), random_(seed) {
    step_.weights.type = kS8;
    step_.weights.shape = {c.channels, c.input[1], c.kernel[0], c.kernel[1]};
    const auto weights = c.channels * c.input[1] * c.kernel[0] * c.kernel[1];
    for (int64_t i = 0; i < weights; ++i) {
      step_.weights.bytes.push_back(std::byte(static_cast<int8_t>(random_() % 127) - 63));
    }
    for (int64_t i = 0; i < c.channels; ++i) {
      step_.weight_scale.push_back(0.0001F * static_cast<float>(1 + random_() % 50));
      step_.bias.push_back(0.01F * (static_cast<float>(random_() % 100) - 50.0F));
    }
    step_.strides = c.strides;
    step_.pads = c.pads;
    step_.relu = c.relu;
    input_ = {c.input, c.input_type, 0.02F};
    const auto cells = [&](int axis) {
      const auto a = static_cast<size_t>(axis);
      return (c.input[a + 2] + c.pads[a] + c.pads[a + 2] - c.kernel[a]) / c.strides[a] + 1;
    };
    output_ = {{c.input[0], c.channels, cells(0), cells(1)},
               c.output_type,
               c.output_type == kF32 ? 1.0F : 0.1F};
    input_elements_ = random_bytes(count(input_), random_);
    if (c.residual == kNone) return;
    residual_ = {output_.dims, c.residual, 0.07F};
    if (c.residual != kF32) {
      residual_elements_ = random_bytes(count(output_), random_);
      return;
    }
    for (size_t i = 0; i < count(output_); ++i) {
      const float value = 0.25F * static_cast<float>(random_() % 400) - 50.0F;
      const auto* bytes = reinterpret_cast<const std::byte*>(&value);
      residual_elements_.insert(residual_elements_.end(), bytes, bytes + sizeof(value));
    }
  }

  bool can_run(const KernelSet& kernels) const {
    return DirectConvolution::can_run(step_, input_, kernels);
  }
  ConvStep& step() { return step_; }

  DirectConvolution make(const KernelSet& kernels) const {
    return {step_, input_, output_, has_residual() ? &residual_ : nullptr, kernels, case_.order};
  }

  /// The output, computed in pieces of `rows` rows.
  std::vector<std::byte> run(const KernelSet& kernels, int rows = 1 << 20) const {
    const DirectConvolution convolution = make(kernels);
    std::vector<std::byte> output(count(output_) * size_in_bytes(output_.type));
    std::vector<std::byte> scratch(convolution.scratch_bytes());
    for (int begin = 0; begin < convolution.rows(); begin += rows) {
      convolution.run(input_elements_.data(), has_residual() ? residual_elements_.data() : nullptr,
                      output.data(), begin, std::min(begin + rows, convolution.rows()),
                      scratch.data());
    }
    return output;
  }

  /// One output element before rounding, computed by definition in double precision.
  double exact(int64_t n, int64_t channel, int64_t row, int64_t col) const {
    const auto [rows, cols] = case_.kernel;
    int64_t sum = 0;
    for (int64_t in = 0; in < case_.input[1]; ++in) {
      for (int64_t i = 0; i < rows * cols; ++i) {
        const int64_t y = row * case_.strides[0] - case_.pads[0] + i / cols;
        const int64_t x = col * case_.strides[1] - case_.pads[1] + i % cols;
        if (y < 0 || x < 0 || y >= case_.input[2] || x >= case_.input[3]) continue;
        const auto weight = (channel * case_.input[1] + in) * rows * cols + i;
        sum += static_cast<int64_t>(
            element(input_elements_, input_.type, place(input_, case_.order, n, in, y, x)) *
            element(step_.weights.bytes, kS8, static_cast<size_t>(weight)));
      }
    }
    const auto c = static_cast<size_t>(channel);
    double real = static_cast<double>(sum) * step_.weight_scale[c] * input_.scale + step_.bias[c];
    if (has_residual()) {
      const size_t i = place(output_, ChannelOrder::kLast, n, channel, row, col);
      real += residual_.scale * element(residual_elements_, residual_.type, i);
    }
    return (case_.relu ? std::max(real, 0.0) : real) / output_.scale;
  }

  /// The largest difference from exact(), saturated to the range of the output type.
  double largest_error(const std::vector<std::byte>& elements) const {
    const double lowest = output_.type == kU8 ? 0.0 : -128.0;
    const double highest = output_.type == kU8 ? 255.0 : 127.0;
    double largest = 0.0;
    for (int64_t n = 0; n < output_.dims[0]; ++n) {
      for (int64_t c = 0; c < output_.dims[1]; ++c) {
        for (int64_t row = 0; row < output_.dims[2]; ++row) {
          for (int64_t col = 0; col < output_.dims[3]; ++col) {
            double wanted = exact(n, c, row, col);
            if (output_.type != kF32) wanted = std::clamp(wanted, lowest, highest);
            const size_t i = place(output_, ChannelOrder::kLast, n, c, row, col);
            largest = std::max(largest, std::abs(element(elements, output_.type, i) - wanted));
          }
        }
      }
    }
    return largest;
  }

 private:
  static size_t count(const Value& value) {
    return static_cast<size_t>(value.dims[0] * value.dims[1] * value.dims[2] * value.dims[3]);
  }
  static size_t place(const Value& value, ChannelOrder order, int64_t n, int64_t c, int64_t row,
                      int64_t col) {
    const auto [images, channels, rows, cols] = value.dims;
    return static_cast<size_t>(order == ChannelOrder::kLast
                                   ? ((n * rows + row) * cols + col) * channels + c
                                   : ((n * channels + c) * rows + row) * cols + col);
  }
  bool has_residual() const { return case_.residual != kNone; }

  Case case_;
  std::mt19937 random_;
  ConvStep step_;
  Value input_;
  Value output_;
  Value residual_;
  std::vector<std::byte> input_elements_;
  std::vector<std::byte> residual_elements_;
};

class DirectConvolutionTest : public testing::TestWithParam<Case> {};

TEST_P(DirectConvolutionTest, EveryKernelSetRoundsTheExactSum) {
  const Layer layer(GetParam());
  // Rounding changes a value by at most half a step. A float has seven digits.
  const double bound = GetParam().output_type == kF32 ? 1.0e-4 : 0.5001;
  for (const KernelSet* kernels : kernel_sets()) {
    ASSERT_TRUE(layer.can_run(*kernels)) << kernels->name;
    EXPECT_LE(layer.largest_error(layer.run(*kernels)), bound) << kernels->name;
  }
}

TEST_P(DirectConvolutionTest, AllKernelSetsAgreeToTheBit) {
  const Layer layer(GetParam(), 2);
  const auto plain = layer.run(*kernel_sets().back());
  for (const KernelSet* kernels : kernel_sets()) {
    EXPECT_EQ(layer.run(*kernels), plain) << kernels->name;
  }
}

TEST_P(DirectConvolutionTest, PiecesMakeTheWhole) {
  const Layer layer(GetParam(), 3);
  const KernelSet& kernels = *kernel_sets().front();
  const auto whole = layer.run(kernels);
  EXPECT_EQ(layer.run(kernels, 1), whole);
  EXPECT_EQ(layer.run(kernels, 3), whole);
}

INSTANTIATE_TEST_SUITE_P(
    Layers, DirectConvolutionTest,
    testing::Values(
        Case{.what = "Plain", .input = {2, 16, 9, 11}, .channels = 16},
        Case{.what = "OneVectorAndAHalf", .input = {1, 8, 5, 50}, .channels = 24},
        Case{.what = "TwoVectorsAndAHalf", .input = {1, 4, 5, 21}, .channels = 40},
        Case{.what = "ThreeVectors", .input = {1, 12, 6, 20}, .channels = 48},
        Case{.what = "SeveralGroups", .input = {1, 8, 4, 13}, .channels = 136},
        Case{.what = "FewChannels", .input = {1, 4, 6, 7}, .channels = 4},
        Case{.what = "OddChannels", .input = {1, 7, 6, 7}, .channels = 21},
        Case{.what = "OneChannel", .input = {1, 1, 6, 7}, .channels = 1},
        Case{.what = "Stride2", .input = {2, 12, 10, 17}, .channels = 24, .strides = {2, 2}},
        Case{.what = "UnevenPads",
             .input = {1, 4, 8, 9},
             .channels = 8,
             .strides = {2, 1},
             .pads = {0, 1, 1, 0}},
        Case{.what = "NoPads", .input = {1, 8, 7, 9}, .channels = 8, .pads = {}},
        Case{.what = "OneByOne",
             .input = {2, 40, 6, 9},
             .channels = 48,
             .kernel = {1, 1},
             .pads = {}},
        Case{.what = "OneByOneStride2",
             .input = {1, 8, 7, 9},
             .channels = 8,
             .kernel = {1, 1},
             .strides = {2, 2},
             .pads = {}},
        Case{.what = "FiveByThree",
             .input = {1, 6, 8, 9},
             .channels = 8,
             .kernel = {5, 3},
             .pads = {2, 1, 2, 1}},
        Case{.what = "SignedInput", .input = {1, 8, 6, 9}, .channels = 16, .input_type = kS8},
        Case{.what = "SignedOneByOne",
             .input = {1, 8, 6, 9},
             .channels = 16,
             .kernel = {1, 1},
             .pads = {},
             .input_type = kS8},
        Case{.what = "Planes",
             .input = {2, 3, 8, 33},
             .channels = 12,
             .strides = {2, 2},
             .input_type = kS8,
             .order = ChannelOrder::kPlanes},
        Case{.what = "UnsignedPlanes",
             .input = {1, 2, 8, 9},
             .channels = 12,
             .order = ChannelOrder::kPlanes},
        Case{.what = "ToInt8",
             .input = {1, 8, 6, 9},
             .channels = 20,
             .output_type = kS8,
             .relu = false},
        Case{.what = "ToFloat",
             .input = {1, 8, 6, 9},
             .channels = 21,
             .output_type = kF32,
             .relu = false},
        Case{.what = "FloatAfterRelu", .input = {1, 8, 6, 9}, .channels = 8, .output_type = kF32},
        Case{.what = "ResidualOfUint8", .input = {1, 8, 6, 9}, .channels = 20, .residual = kU8},
        Case{.what = "ResidualOfInt8",
             .input = {1, 8, 6, 9},
             .channels = 16,
             .output_type = kS8,
             .residual = kS8,
             .relu = false},
        Case{.what = "Uint8ToFloat",
             .input = {1, 8, 6, 9},
             .channels = 16,
             .output_type = kF32,
             .residual = kU8,
             .relu = false},
        Case{.what = "FloatToFloat",
             .input = {1, 8, 6, 9},
             .channels = 13,
             .output_type = kF32,
             .residual = kF32,
             .relu = false}),
    [](const auto& layer) { return layer.param.what; });

TEST(DirectConvolution, KernelSetsAgreeForEveryWidth) {
  for (const int64_t channels : {8, 16, 24}) {
    for (int64_t width = 1; width <= 25; ++width) {
      const Layer layer({.what = "", .input = {1, 4, 2, width}, .channels = channels});
      const auto plain = layer.run(*kernel_sets().back());
      for (const KernelSet* kernels : kernel_sets()) {
        EXPECT_EQ(layer.run(*kernels), plain) << kernels->name << ", width " << width;
      }
    }
  }
}

TEST(DirectConvolution, ResidualMayBeTheOutputsOwnMemory) {
  const Case c{.what = "", .input = {1, 8, 6, 9}, .channels = 20, .residual = kU8};
  const Value input{c.input, kU8, 0.02F};
  const Value output{{1, 20, 6, 9}, kU8, 0.1F};
  Layer layer(c);
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
  const Case c{.what = "", .input = {1, 8, 6, 9}, .channels = 8};
  const Value input{c.input, kU8, 0.02F};
  for (const KernelSet* kernels : kernel_sets()) {
    const auto can_run = [&](auto change) {
      Layer layer(c);
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
    Layer layer(c);
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

TEST(Requantize, RoundsHalfToEvenAndCutsOff) {
  Requantizer requantizer;
  requantizer.channels = 11;
  requantizer.scale.assign(11, 0.5F);
  std::vector<int32_t> sums{1, 3, 5, -1, -3, 510, 511, 9000, -9000, 2'000'000'000, 4};
  sums.resize(16);  // kernels read whole vectors
  const auto rounded = [&](ElementType type, Requantize requantize) {
    requantizer.output = type;
    std::vector<int> results;
    std::array<uint8_t, 11> output{};
    requantize(requantizer, {.sums = sums.data(),
                             .sums_step = 16,
                             .pixels = 1,
                             .output = std::as_writable_bytes(std::span(output)).data()});
    for (const uint8_t byte : output) {
      results.push_back(type == kU8 ? byte : static_cast<int8_t>(byte));
    }
    return results;
  };
  const auto best = [](ElementType type) {
    Requantizer any;
    any.output = type;
    return requantize_for(any, false);
  };
  const std::vector<int> unsigned_wanted{0, 2, 2, 0, 0, 255, 255, 255, 0, 255, 2};
  const std::vector<int> signed_wanted{0, 2, 2, 0, -2, 127, 127, 127, -128, 127, 2};
  EXPECT_EQ(rounded(kU8, requantize_plain(kU8, kU8, false)), unsigned_wanted);
  EXPECT_EQ(rounded(kS8, requantize_plain(kS8, kU8, false)), signed_wanted);
  EXPECT_EQ(rounded(kU8, best(kU8)), unsigned_wanted);
  EXPECT_EQ(rounded(kS8, best(kS8)), signed_wanted);
}

}  // namespace
}  // namespace bevloc::nn
