#include "pipeline/network/engines/xnnpack/convolution.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include "pipeline/network/model/load_error.h"

namespace bevloc::nn::xnnpack {
namespace {

/// Lets worker threads sleep between operators. If they spun, they would occupy cores that other
/// threads of the process need.
constexpr uint32_t kFlags = XNN_FLAG_YIELD_WORKERS;

struct DeleteOperator {
  void operator()(xnn_operator_t op) const { xnn_delete_operator(op); }
};
using Operator = std::unique_ptr<xnn_operator, DeleteOperator>;

void check(xnn_status status, const Shape& weights) {
  if (status == xnn_status_success) return;
  refuse("XNNPACK cannot run a convolution with weights {} (status {})", to_string(weights),
         static_cast<int>(status));
}

/// Weights [out, in, rows, cols] in the order [out, rows, cols, in].
template <typename Element>
std::vector<Element> channel_last(std::span<const Element> weights, const Shape& shape) {
  const int64_t in_channels = shape[1];
  const int64_t cells = shape[2] * shape[3];
  std::vector<Element> result(weights.size());
  for (int64_t out = 0; out < shape[0]; ++out) {
    for (int64_t in = 0; in < in_channels; ++in) {
      for (int64_t cell = 0; cell < cells; ++cell) {
        result[(out * cells + cell) * in_channels + in] =
            weights[(out * in_channels + in) * cells + cell];
      }
    }
  }
  return result;
}

std::vector<int8_t> channel_last_int8(const ConvStep& step) {
  return channel_last(int8_weights(step), step.weights.shape);
}

std::vector<float> float_weights(const ConvStep& step) {
  if (step.weights.type == ElementType::kFloat32) {
    return channel_last<float>(step.weights.floats(), step.weights.shape);
  }
  const std::vector<int8_t> weights = channel_last_int8(step);
  return {weights.begin(), weights.end()};
}

/// The bias in units of the sum, rounded, so that sums of integers remain integers. Empty if there
/// is no bias.
template <typename Element>
std::vector<Element> whole_bias(const ConvStep& step, const Value& input) {
  const std::vector<float> scale = sum_scale(step, input);
  std::vector<Element> bias;
  for (size_t i = 0; i < step.bias.size(); ++i) {
    constexpr double kLargest = std::numeric_limits<int32_t>::max();
    const double exact = static_cast<double>(step.bias[i]) / scale[i];
    bias.push_back(static_cast<Element>(std::nearbyint(std::clamp(exact, -kLargest, kLargest))));
  }
  return bias;
}

template <typename Element>
const Element* data_or_null(const std::vector<Element>& elements) {
  return elements.empty() ? nullptr : elements.data();
}

/// The parameters of a convolution that both kinds of operators need.
struct Geometry {
  explicit Geometry(const ConvStep& step)
      : top(static_cast<uint32_t>(step.pads[0])),
        left(static_cast<uint32_t>(step.pads[1])),
        bottom(static_cast<uint32_t>(step.pads[2])),
        right(static_cast<uint32_t>(step.pads[3])),
        rows(static_cast<uint32_t>(step.weights.shape[2])),
        cols(static_cast<uint32_t>(step.weights.shape[3])),
        row_stride(static_cast<uint32_t>(step.strides[0])),
        col_stride(static_cast<uint32_t>(step.strides[1])),
        row_dilation(static_cast<uint32_t>(step.dilations[0])),
        col_dilation(static_cast<uint32_t>(step.dilations[1])),
        groups(static_cast<uint32_t>(step.groups)),
        in_channels(static_cast<size_t>(step.weights.shape[1])),
        out_channels(static_cast<size_t>(step.weights.shape[0] / step.groups)) {}

  uint32_t top, left, bottom, right;
  uint32_t rows, cols;
  uint32_t row_stride, col_stride;
  uint32_t row_dilation, col_dilation;
  uint32_t groups;
  size_t in_channels, out_channels;  ///< per group
};

Operator make_quantized_operator(const ConvStep& step, const Value& input, const Value& output) {
  const Geometry g(step);
  const int zero = zero_point(output.type);
  const int lowest = step.relu ? zero : std::numeric_limits<int8_t>::min();
  const std::vector<int8_t> weights = channel_last_int8(step);
  const std::vector<int32_t> bias = whole_bias<int32_t>(step, input);
  xnn_operator_t made = nullptr;
  check(xnn_create_convolution2d_nhwc_qc8(
            g.top, g.right, g.bottom, g.left, g.rows, g.cols, g.row_stride, g.col_stride,
            g.row_dilation, g.col_dilation, g.groups, g.in_channels, g.out_channels,
            g.groups * g.in_channels, g.groups * g.out_channels,
            static_cast<int8_t>(zero_point(input.type)), input.scale, step.weight_scale.data(),
            weights.data(), data_or_null(bias), static_cast<int8_t>(zero), output.scale,
            static_cast<int8_t>(lowest), std::numeric_limits<int8_t>::max(), kFlags, &made),
        step.weights.shape);
  return Operator(made);
}

Operator make_float_operator(const ConvStep& step, const Value& input, bool relu) {
  const Geometry g(step);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const bool is_float = step.weights.type == ElementType::kFloat32;
  const std::vector<float> weights = float_weights(step);
  const std::vector<float> bias = is_float ? step.bias : whole_bias<float>(step, input);
  xnn_operator_t made = nullptr;
  check(xnn_create_convolution2d_nhwc_f32(
            g.top, g.right, g.bottom, g.left, g.rows, g.cols, g.row_stride, g.col_stride,
            g.row_dilation, g.col_dilation, g.groups, g.in_channels, g.out_channels,
            g.groups * g.in_channels, g.groups * g.out_channels, weights.data(), data_or_null(bias),
            relu ? 0.0F : -kInfinity, kInfinity, kFlags, &made),
        step.weights.shape);
  return Operator(made);
}

class ConvolutionTask : public Task {
 public:
  ConvolutionTask(Operator op, bool is_float, const ConvStep& step, const Value& input, size_t from,
                  size_t to)
      : operator_(std::move(op)),
        is_float_(is_float),
        weights_(step.weights.shape),
        images_(static_cast<size_t>(input.dims[0])),
        rows_(static_cast<size_t>(input.dims[2])),
        cols_(static_cast<size_t>(input.dims[3])),
        from_(from),
        to_(to) {}

  void bind(std::span<std::byte* const> storages, pthreadpool_t threads) override {
    const std::byte* const from = storages[from_];
    std::byte* const to = storages[to_];
    if (is_float_) {
      check(xnn_setup_convolution2d_nhwc_f32(operator_.get(), images_, rows_, cols_,
                                             reinterpret_cast<const float*>(from),
                                             reinterpret_cast<float*>(to), threads),
            weights_);
    } else {
      check(xnn_setup_convolution2d_nhwc_qc8(operator_.get(), images_, rows_, cols_,
                                             reinterpret_cast<const int8_t*>(from),
                                             reinterpret_cast<int8_t*>(to), threads),
            weights_);
    }
  }

  void run(pthreadpool_t threads) override {
    [[maybe_unused]] const xnn_status status = xnn_run_operator(operator_.get(), threads);
    assert(status == xnn_status_success);
  }

 private:
  Operator operator_;
  bool is_float_;
  Shape weights_;
  size_t images_;
  size_t rows_;
  size_t cols_;
  size_t from_;
  size_t to_;
};

}  // namespace

std::vector<float> sum_scale(const ConvStep& step, const Value& input) {
  if (step.weight_scale.empty()) {
    return std::vector<float>(static_cast<size_t>(step.weights.shape[0]), 1.0F);
  }
  std::vector<float> scale = step.weight_scale;
  for (float& s : scale) s *= input.scale;
  return scale;
}

std::unique_ptr<Task> quantized_convolution(const ConvStep& step, const Value& input,
                                            const Value& output, size_t from, size_t to) {
  return std::make_unique<ConvolutionTask>(make_quantized_operator(step, input, output), false,
                                           step, input, from, to);
}

std::unique_ptr<Task> float_convolution(const ConvStep& step, const Value& input, bool relu,
                                        size_t from, size_t to) {
  return std::make_unique<ConvolutionTask>(make_float_operator(step, input, relu), true, step,
                                           input, from, to);
}

}  // namespace bevloc::nn::xnnpack
