#include "pipeline/network/model/lowering_window.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/network/model/limits.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

/// An attribute of two numbers: one for the rows, one for the columns.
std::array<int64_t, 2> rows_and_cols(const Node& node, const std::string& name, int64_t fallback,
                                     int64_t largest) {
  const std::vector<int64_t> numbers = node.integers(name, {fallback, fallback});
  const auto is_in_range = [largest](int64_t n) { return n >= 1 && n <= largest; };
  if (numbers.size() != 2 || !std::ranges::all_of(numbers, is_in_range)) {
    refuse("{}: {} is {}, wanted two numbers of 1 to {}", node.label, name, to_string(numbers),
           largest);
  }
  return {numbers[0], numbers[1]};
}

/// Rows and columns that a window covers. Padding must be smaller, so that each window covers at
/// least one cell of the image: the kernels rely on it.
using WindowSize = std::array<int64_t, 2>;

std::array<int64_t, 4> padding(const Node& node, const WindowSize& window) {
  if (node.text("auto_pad", "NOTSET") != "NOTSET") {
    refuse("{}: auto_pad is not supported, wanted pads", node.label);
  }
  const std::vector<int64_t> pads = node.integers("pads", {0, 0, 0, 0});
  if (pads.size() != 4 || std::ranges::any_of(pads, [](int64_t n) { return n < 0; })) {
    refuse("{}: pads are {}, wanted four numbers of at least 0", node.label, to_string(pads));
  }
  for (size_t i = 0; i < pads.size(); ++i) {
    if (pads[i] >= window[i % 2]) {
      refuse("{}: pads are {}, wanted fewer than the {}x{} cells of the window", node.label,
             to_string(pads), window[0], window[1]);
    }
  }
  return {pads[0], pads[1], pads[2], pads[3]};
}

/// How many positions the window has along one axis.
int64_t window_count(const Node& node, int64_t length, int64_t pads, int64_t window,
                     int64_t stride) {
  const int64_t travel = length + pads - window;
  if (travel < 0) {
    refuse("{}: a window of {} does not fit into {} cells", node.label, window, length + pads);
  }
  return travel / stride + 1;
}

std::vector<float> bias_of(const LoweringState& state, const Node& node, int64_t channels) {
  if (!node.has_input(2)) return {};
  std::vector<float> bias;
  if (const Tensor* constant = state.constant(node.inputs[2])) {
    bias = constant->floats();
  } else if (const auto* quantized = std::get_if<QuantizedConstant>(&state.symbol(node, 2))) {
    bias = quantized->real_values();
  }
  if (static_cast<int64_t>(bias.size()) != channels) {
    refuse("{}: bias has {} elements, wanted {}", node.label, bias.size(), channels);
  }
  return bias;
}

void set_weights(const LoweringState& state, const Node& node, ConvStep& conv) {
  if (const Tensor* constant = node.has_input(1) ? state.constant(node.inputs[1]) : nullptr) {
    conv.weights = *constant;
  } else if (const auto* quantized = std::get_if<QuantizedConstant>(&state.symbol(node, 1))) {
    conv.weights = quantized->elements;
    conv.weight_scale = quantized->scale;
  } else {
    refuse("{}: the weights are not constant", node.label);
  }
  const bool is_int8 = conv.weights.type == ElementType::kInt8 && !conv.weight_scale.empty();
  const bool is_float = conv.weights.type == ElementType::kFloat32;
  if (conv.weights.shape.size() != 4 || !(is_int8 || is_float)) {
    refuse("{}: weights are {} {}, wanted four axes of float or of int8 with a scale", node.label,
           name_of(conv.weights.type), to_string(conv.weights.shape));
  }
  conv.weight_scale.resize(static_cast<size_t>(is_int8 ? conv.weights.shape[0] : 0),
                           is_int8 ? conv.weight_scale[0] : 1.0F);
}

/// Keeps int8 weights only if the input is quantized, too. Otherwise the convolution computes in
/// float.
void choose_precision(LoweringState& state, ConvStep& conv) {
  const bool weights_int8 = conv.weights.type == ElementType::kInt8;
  if (weights_int8 && is_8_bit(state.value(conv.input).type)) return;
  conv.input = state.as_float(conv.input);
  if (!weights_int8) return;
  const std::vector<float> real = QuantizedConstant{conv.weights, conv.weight_scale}.real_values();
  const auto bytes = std::as_bytes(std::span(real));
  conv.weights.type = ElementType::kFloat32;
  conv.weights.bytes.assign(bytes.begin(), bytes.end());
  conv.weight_scale.clear();
}

/// Refuses an int8 convolution whose sums do not fit into an int32.
void check_sums(LoweringState& state, const Node& node, const ConvStep& conv) {
  if (conv.weights.type != ElementType::kInt8) return;
  const Shape& weights = conv.weights.shape;
  const int64_t products = weights[1] * weights[2] * weights[3];
  if (products > kMostProducts) {
    refuse("{}: weights {} give sums of {} products, wanted at most {}", node.label,
           to_string(weights), products, kMostProducts);
  }
  constexpr float kLargestBias = 1 << 30;
  const float input_scale = state.value(conv.input).scale;
  for (size_t c = 0; c < conv.bias.size(); ++c) {
    const float units = conv.bias[c] / (conv.weight_scale[c] * input_scale);
    if (!(std::abs(units) <= kLargestBias)) {
      refuse("{}: bias {} of channel {} is {} units of its sum, wanted at most {}", node.label,
             conv.bias[c], c, units, kLargestBias);
    }
  }
}

}  // namespace

void lower_conv(LoweringState& state, const Node& node) {
  ConvStep conv;
  set_weights(state, node, conv);
  conv.input = state.materialized_input(node, 0);
  conv.groups = node.integer("group", 1);
  conv.strides = rows_and_cols(node, "strides", 1, kLargestStep);
  conv.dilations = rows_and_cols(node, "dilations", 1, kLargestStep);

  const Shape& weights = conv.weights.shape;
  const auto dims = state.value(conv.input).dims;
  if (conv.groups < 1 || weights[0] % conv.groups != 0 || dims[1] != weights[1] * conv.groups) {
    refuse("{}: weights {} in {} groups do not fit {} input channels", node.label,
           to_string(weights), conv.groups, dims[1]);
  }
  const std::vector<int64_t> kernel = node.integers("kernel_shape", {weights[2], weights[3]});
  if (kernel != std::vector<int64_t>{weights[2], weights[3]}) {
    refuse("{}: kernel_shape {} does not fit weights {}", node.label, to_string(kernel),
           to_string(weights));
  }
  conv.bias = bias_of(state, node, weights[0]);
  choose_precision(state, conv);
  check_sums(state, node, conv);
  const WindowSize window{(weights[2] - 1) * conv.dilations[0] + 1,
                          (weights[3] - 1) * conv.dilations[1] + 1};
  conv.pads = padding(node, window);
  const int64_t rows =
      window_count(node, dims[2], conv.pads[0] + conv.pads[2], window[0], conv.strides[0]);
  const int64_t cols =
      window_count(node, dims[3], conv.pads[1] + conv.pads[3], window[1], conv.strides[1]);
  conv.output = state.define_value(node, {dims[0], weights[0], rows, cols});
  state.program().steps.push_back(std::move(conv));
}

void lower_max_pool(LoweringState& state, const Node& node) {
  if (node.integer("ceil_mode", 0) != 0 || node.integer("storage_order", 0) != 0 ||
      rows_and_cols(node, "dilations", 1, kLargestStep) != std::array<int64_t, 2>{1, 1}) {
    refuse("{}: ceil_mode, storage_order and dilations are not supported", node.label);
  }
  MaxPoolStep pool;
  pool.input = state.materialized_input(node, 0);
  pool.kernel = rows_and_cols(node, "kernel_shape", 0, kLargestWindow);
  pool.strides = rows_and_cols(node, "strides", 1, kLargestStep);
  pool.pads = padding(node, pool.kernel);
  const Value input = state.value(pool.input);
  const int64_t rows = window_count(node, input.dims[2], pool.pads[0] + pool.pads[2],
                                    pool.kernel[0], pool.strides[0]);
  const int64_t cols = window_count(node, input.dims[3], pool.pads[1] + pool.pads[3],
                                    pool.kernel[1], pool.strides[1]);
  pool.output =
      state.define_value(node, {input.dims[0], input.dims[1], rows, cols}, input.type, input.scale);
  state.program().steps.push_back(pool);
}

}  // namespace bevloc::nn
