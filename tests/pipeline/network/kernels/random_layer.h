// A convolution with random weights and input, for tests of its kernels: its output by a kernel
// set, and by definition in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <ostream>
#include <random>
#include <vector>

#include "pipeline/network/kernels/direct_convolution.h"

namespace bevloc::test {

inline constexpr auto kU8 = nn::ElementType::kUint8;
inline constexpr auto kS8 = nn::ElementType::kInt8;
inline constexpr auto kF32 = nn::ElementType::kFloat32;

/// Stands for "no residual".
inline constexpr auto kNone = nn::ElementType::kInt64;

struct LayerCase {
  const char* what;              ///< name of the test case
  std::array<int64_t, 4> input;  ///< n, c, h, w
  int64_t channels;
  std::array<int64_t, 2> kernel{3, 3};
  std::array<int64_t, 2> strides{1, 1};
  std::array<int64_t, 4> pads{1, 1, 1, 1};
  nn::ElementType input_type = kU8;
  nn::ElementType output_type = kU8;
  nn::ElementType residual = kNone;
  bool relu = true;
  nn::ChannelOrder order = nn::ChannelOrder::kLast;
};

inline void PrintTo(const LayerCase& c, std::ostream* out) {
  *out << c.what;
}

inline std::vector<std::byte> random_bytes(size_t count, std::mt19937& random) {
  std::vector<std::byte> bytes(count);
  std::ranges::generate(bytes, [&random] { return static_cast<std::byte>(random() & 0xFFU); });
  return bytes;
}

inline double element(const std::vector<std::byte>& bytes, nn::ElementType type, size_t i) {
  if (type == kU8) return static_cast<double>(static_cast<uint8_t>(bytes[i]));
  if (type == kS8) return static_cast<double>(static_cast<int8_t>(bytes[i]));
  float value = 0.0F;
  std::memcpy(&value, bytes.data() + i * sizeof(float), sizeof(float));
  return static_cast<double>(value);
}

/// A convolution with random weights and input.
class RandomLayer {
 public:
  explicit RandomLayer(const LayerCase& c, uint32_t seed = 1) : case_(c), random_(seed) {
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

  bool can_run(const nn::KernelSet& kernels) const {
    return nn::DirectConvolution::can_run(step_, input_, kernels);
  }
  nn::ConvStep& step() { return step_; }

  nn::DirectConvolution make(const nn::KernelSet& kernels) const {
    return {step_, input_, output_, has_residual() ? &residual_ : nullptr, kernels, case_.order};
  }

  /// The output, computed in pieces of `rows` rows.
  std::vector<std::byte> run(const nn::KernelSet& kernels, int rows = 1 << 20) const {
    const nn::DirectConvolution convolution = make(kernels);
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
      const size_t i = place(output_, nn::ChannelOrder::kLast, n, channel, row, col);
      real += residual_.scale * element(residual_elements_, residual_.type, i);
    }
    return (case_.relu ? std::max(real, 0.0) : real) / output_.scale;
  }

  /// The largest difference from exact(), saturated to the range of the output type. Infinite if an
  /// element is not finite.
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
            const size_t i = place(output_, nn::ChannelOrder::kLast, n, c, row, col);
            const double error = std::abs(element(elements, output_.type, i) - wanted);
            if (!std::isfinite(error)) return std::numeric_limits<double>::infinity();
            largest = std::max(largest, error);
          }
        }
      }
    }
    return largest;
  }

 private:
  static size_t count(const nn::Value& value) {
    return static_cast<size_t>(value.dims[0] * value.dims[1] * value.dims[2] * value.dims[3]);
  }
  static size_t place(const nn::Value& value, nn::ChannelOrder order, int64_t n, int64_t c,
                      int64_t row, int64_t col) {
    const auto [images, channels, rows, cols] = value.dims;
    return static_cast<size_t>(order == nn::ChannelOrder::kLast
                                   ? ((n * rows + row) * cols + col) * channels + c
                                   : ((n * channels + c) * rows + row) * cols + col);
  }
  bool has_residual() const { return case_.residual != kNone; }

  LayerCase case_;
  std::mt19937 random_;
  nn::ConvStep step_;
  nn::Value input_;
  nn::Value output_;
  nn::Value residual_;
  std::vector<std::byte> input_elements_;
  std::vector<std::byte> residual_elements_;
};

}  // namespace bevloc::test
