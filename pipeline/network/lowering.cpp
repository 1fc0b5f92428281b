#include "pipeline/network/lowering.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/network/load_error.h"
#include "pipeline/network/lowering_state.h"
#include "pipeline/network/lowering_view.h"

namespace bevloc::nn {
namespace {

bool is_8_bit(ElementType type) {
  return type == ElementType::kInt8 || type == ElementType::kUint8;
}

/// Scales of a (De)QuantizeLinear node: all positive, zero points all 0.
std::vector<float> checked_scales(const LoweringState& state, const Node& node) {
  const std::vector<float> scales = state.constant_input(node, 1, "scale").floats();
  for (const float scale : scales) {
    if (!(scale > 0.0F) || !std::isfinite(scale)) {
      refuse("{}: scale is {}, wanted more than 0", node.label, scale);
    }
  }
  if (scales.empty()) refuse("{}: there is no scale", node.label);
  if (node.has_input(2)) {
    for (const int64_t zero_point : state.constant_input(node, 2, "zero point").integers()) {
      if (zero_point != 0) refuse("{}: zero point is {}, wanted 0", node.label, zero_point);
    }
  }
  return scales;
}

float single_scale(const LoweringState& state, const Node& node) {
  const std::vector<float> scales = checked_scales(state, node);
  if (scales.size() != 1) refuse("{}: activations must have one scale", node.label);
  return scales[0];
}

void dequantize_constant(LoweringState& state, const Node& node, const Tensor& elements) {
  const std::vector<float> scales = checked_scales(state, node);
  const int64_t axis = node.integer("axis", 1);
  const bool per_channel = axis == 0 && !elements.shape.empty() &&
                           static_cast<int64_t>(scales.size()) == elements.shape[0];
  if (scales.size() != 1 && !per_channel) {
    refuse("{}: {} scales along axis {} of shape {}, wanted one or one per channel along axis 0",
           node.label, scales.size(), axis, to_string(elements.shape));
  }
  state.define(node.output, QuantizedConstant{elements, scales});
}

void lower_dequantize(LoweringState& state, const Node& node) {
  if (const Tensor* elements = state.constant(node.inputs.at(0))) {
    return dequantize_constant(state, node, *elements);
  }
  const auto* input = std::get_if<Activation>(&state.symbol(node, 0));
  if (input == nullptr || input->is_real) {
    refuse("{}: input is not a quantized activation", node.label);
  }
  const float scale = single_scale(state, node);
  Value& value = state.value(input->value);
  if (value.scale == 0.0F) value.scale = scale;
  if (value.scale != scale) {
    refuse("{}: scale is {}, but the activation was quantized with {}", node.label, scale,
           value.scale);
  }
  state.define_alias(node, Activation{input->value, input->layout, true});
}

/// Lets the step that computes the activation round its result itself.
bool fold_quantize(LoweringState& state, const Node& node, const Activation& input,
                   ElementType type, float scale) {
  Step* step = state.open_step(node.inputs[0], input);
  if (step == nullptr) return false;
  if (const auto* conv = std::get_if<ConvStep>(step)) {
    const bool is_int8 = conv->weights.type == ElementType::kInt8;
    const bool residual_fits = conv->residual < 0 || is_8_bit(state.value(conv->residual).type);
    if (!is_int8 || !residual_fits) return false;
  } else if (!std::holds_alternative<ViewStep>(*step) && !std::holds_alternative<AddStep>(*step)) {
    return false;
  }
  state.value(input.value).type = type;
  state.value(input.value).scale = scale;
  return true;
}

void lower_quantize(LoweringState& state, const Node& node) {
  const Activation input = state.real_activation(node, 0);
  const float scale = single_scale(state, node);
  const ElementType type =
      node.has_input(2) ? state.constant_input(node, 2, "zero point").type : ElementType::kUint8;
  if (!is_8_bit(type)) refuse("{}: wanted uint8 or int8", node.label);
  const Value value = state.value(input.value);
  int output = input.value;
  if ((value.type != type || value.scale != scale) &&
      !fold_quantize(state, node, input, type, scale)) {
    output = state.add_value(value.dims, type, scale);
    state.program().steps.push_back(ConvertStep{input.value, output});
  }
  state.define_alias(node, Activation{output, input.layout, false});
}

/// Two spatial numbers of an attribute: rows, columns.
std::array<int64_t, 2> rows_and_cols(const Node& node, const std::string& name, int64_t fallback) {
  const std::vector<int64_t> numbers = node.integers(name, {fallback, fallback});
  if (numbers.size() != 2 || numbers[0] < 1 || numbers[1] < 1) {
    refuse("{}: {} is {}, wanted two positive numbers", node.label, name, to_string(numbers));
  }
  return {numbers[0], numbers[1]};
}

std::array<int64_t, 4> padding(const Node& node) {
  if (node.text("auto_pad", "NOTSET") != "NOTSET") {
    refuse("{}: auto_pad is not supported, wanted pads", node.label);
  }
  const std::vector<int64_t> pads = node.integers("pads", {0, 0, 0, 0});
  if (pads.size() != 4 || std::ranges::any_of(pads, [](int64_t n) { return n < 0; })) {
    refuse("{}: pads are {}, wanted four numbers of at least 0", node.label, to_string(pads));
  }
  return {pads[0], pads[1], pads[2], pads[3]};
}

int64_t window_count(const Node& node, int64_t length, int64_t pads, int64_t window,
                     int64_t stride) {
  const int64_t free = length + pads - window;
  if (free < 0) {
    refuse("{}: a window of {} does not fit into {} cells", node.label, window, length + pads);
  }
  return free / stride + 1;
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
    refuse("{}: bias has {} constants, wanted {}", node.label, bias.size(), channels);
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
    refuse("{}: the weights are not constants", node.label);
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

/// int8 needs both sides quantized: else the convolution is computed in float.
void settle_precision(LoweringState& state, ConvStep& conv) {
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

void lower_conv(LoweringState& state, const Node& node) {
  ConvStep conv;
  set_weights(state, node, conv);
  conv.input = state.materialized_input(node, 0);
  conv.groups = node.integer("group", 1);
  conv.strides = rows_and_cols(node, "strides", 1);
  conv.dilations = rows_and_cols(node, "dilations", 1);
  conv.pads = padding(node);

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
  settle_precision(state, conv);
  const int64_t rows = window_count(node, dims[2], conv.pads[0] + conv.pads[2],
                                    (weights[2] - 1) * conv.dilations[0] + 1, conv.strides[0]);
  const int64_t cols = window_count(node, dims[3], conv.pads[1] + conv.pads[3],
                                    (weights[3] - 1) * conv.dilations[1] + 1, conv.strides[1]);
  const std::array<int64_t, 4> output{dims[0], weights[0], rows, cols};
  conv.output = state.add_value(output);
  state.define(node.output, Activation{conv.output, LayoutTrace({output.begin(), output.end()})});
  state.program().steps.push_back(std::move(conv));
}

void lower_max_pool(LoweringState& state, const Node& node) {
  if (node.integer("ceil_mode", 0) != 0 || node.integer("storage_order", 0) != 0 ||
      rows_and_cols(node, "dilations", 1) != std::array<int64_t, 2>{1, 1}) {
    refuse("{}: ceil_mode, storage_order and dilations are not supported", node.label);
  }
  MaxPoolStep pool;
  pool.input = state.materialized_input(node, 0);
  pool.kernel = rows_and_cols(node, "kernel_shape", 0);
  pool.strides = rows_and_cols(node, "strides", 1);
  pool.pads = padding(node);
  const Value input = state.value(pool.input);
  const std::array<int64_t, 4> output{input.dims[0], input.dims[1],
                                      window_count(node, input.dims[2], pool.pads[0] + pool.pads[2],
                                                   pool.kernel[0], pool.strides[0]),
                                      window_count(node, input.dims[3], pool.pads[1] + pool.pads[3],
                                                   pool.kernel[1], pool.strides[1])};
  pool.output = state.add_value(output, input.type, input.scale);
  state.define(node.output, Activation{pool.output, LayoutTrace({output.begin(), output.end()})});
  state.program().steps.push_back(pool);
}

/// Whether the node's sampling positions are those of the executor's twofold upsampling.
bool is_supported_sampling(const Node& node) {
  const std::string mode = node.text("mode", "nearest");
  const std::string position = node.text("coordinate_transformation_mode", "half_pixel");
  const bool half_pixel = position == "half_pixel" || position == "pytorch_half_pixel";
  if (mode == "linear") return half_pixel;
  const std::string rounding = node.text("nearest_mode", "round_prefer_floor");
  const bool asymmetric =
      position == "asymmetric" && (rounding == "floor" || rounding == "round_prefer_floor");
  const bool centred =
      half_pixel && (rounding == "round_prefer_floor" || rounding == "round_prefer_ceil");
  return mode == "nearest" && (asymmetric || centred);
}

void lower_resize(LoweringState& state, const Node& node) {
  if (!is_supported_sampling(node) || node.integer("exclude_outside", 0) != 0) {
    refuse("{}: mode '{}' with coordinates '{}' is not supported", node.label,
           node.text("mode", "nearest"), node.text("coordinate_transformation_mode", "half_pixel"));
  }
  UpsampleStep upsample;
  upsample.input = state.materialized_input(node, 0);
  upsample.linear = node.text("mode", "nearest") == "linear";
  const Value input = state.value(upsample.input);
  const std::array<int64_t, 4> output{input.dims[0], input.dims[1], 2 * input.dims[2],
                                      2 * input.dims[3]};
  const bool twice =
      node.has_input(3)
          ? state.constant_input(node, 3, "size").integers() == Shape{output.begin(), output.end()}
          : state.constant_input(node, 2, "scale").floats() == std::vector<float>{1, 1, 2, 2};
  if (!twice) refuse("{}: wanted twice the rows and columns", node.label);
  if (upsample.linear) upsample.input = state.as_float(upsample.input);
  const Value& source = state.value(upsample.input);
  upsample.output = state.add_value(output, source.type, source.scale);
  state.define(node.output,
               Activation{upsample.output, LayoutTrace({output.begin(), output.end()})});
  state.program().steps.push_back(upsample);
}

/// Adds `residual` inside the convolution that computes input i.
bool fold_add(LoweringState& state, const Node& node, size_t i, int residual) {
  const Activation& activation = state.real_activation(node, i);
  Step* step = state.open_step(node.inputs[i], activation);
  auto* conv = step == nullptr ? nullptr : std::get_if<ConvStep>(step);
  if (conv == nullptr || conv->relu || conv->residual >= 0 || conv->input == residual) return false;
  conv->residual = residual;
  state.move_to_end(step);
  state.define(node.output, activation);
  return true;
}

void lower_add(LoweringState& state, const Node& node) {
  const int left = state.materialized_input(node, 0);
  const int right = state.materialized_input(node, 1);
  const auto dims = state.value(left).dims;
  if (dims != state.value(right).dims) refuse("{}: the inputs differ in shape", node.label);
  if (left != right && (fold_add(state, node, 1, left) || fold_add(state, node, 0, right))) return;
  const int output = state.add_value(dims);
  state.define(node.output, Activation{output, state.real_activation(node, 0).layout});
  state.program().steps.push_back(AddStep{left, right, output});
}

void lower_relu(LoweringState& state, const Node& node) {
  const Activation input = state.real_activation(node, 0);
  Step* step = state.open_step(node.inputs[0], input);
  if (auto* conv = step == nullptr ? nullptr : std::get_if<ConvStep>(step)) {
    conv->relu = true;
    return state.define_alias(node, input);
  }
  if (auto* add = step == nullptr ? nullptr : std::get_if<AddStep>(step)) {
    add->relu = true;
    return state.define_alias(node, input);
  }
  const Value value = state.value(input.value);
  if (value.type == ElementType::kUint8) return state.define_alias(node, input);
  const int output = state.add_value(value.dims, value.type, value.scale);
  state.program().steps.push_back(ReluStep{input.value, output});
  state.define(node.output, Activation{output, input.layout});
}

void lower_concat(LoweringState& state, const Node& node) {
  ConcatStep concat;
  for (size_t i = 0; i < node.inputs.size(); ++i) {
    concat.inputs.push_back(state.materialized_input(node, i));
  }
  if (node.integer("axis", 0) != 1 || concat.inputs.empty()) {
    refuse("{}: wanted axis 1, the channels", node.label);
  }
  const Value first = state.value(concat.inputs[0]);
  std::array<int64_t, 4> dims = first.dims;
  dims[1] = 0;
  bool alike = true;
  for (const int id : concat.inputs) {
    const Value& input = state.value(id);
    const auto& d = input.dims;
    if (d[0] != dims[0] || d[2] != dims[2] || d[3] != dims[3]) {
      refuse("{}: the inputs differ in more than channels", node.label);
    }
    dims[1] += d[1];
    alike = alike && input.type == first.type && input.scale == first.scale;
  }
  if (!alike) {
    for (int& input : concat.inputs) input = state.as_float(input);
  }
  const Value type = state.value(concat.inputs[0]);
  concat.output = state.add_value(dims, type.type, type.scale);
  state.define(node.output, Activation{concat.output, LayoutTrace({dims.begin(), dims.end()})});
  state.program().steps.push_back(concat);
}

void lower_layout(LoweringState& state, const Node& node) {
  const Symbol& input = state.symbol(node, 0);
  if (const auto* activation = std::get_if<Activation>(&input)) {
    Activation moved = *activation;
    moved.layout = traced_through(activation->layout, node, state.graph().constants);
    state.define_alias(node, std::move(moved));
  } else if (const auto* port = std::get_if<ViewPort>(&input)) {
    state.define(node.output, ViewPort{port->is_weight, traced_through(port->layout, node,
                                                                       state.graph().constants)});
  } else {
    refuse("{}: cannot move this input's data", node.label);
  }
}

void lower_node(LoweringState& state, const Node& node) {
  switch (node.op) {
    case Operator::kAdd:
      return lower_add(state, node);
    case Operator::kConcat:
      return lower_concat(state, node);
    case Operator::kConv:
      return lower_conv(state, node);
    case Operator::kDequantizeLinear:
      return lower_dequantize(state, node);
    case Operator::kGather:
      return lower_gather(state, node);
    case Operator::kMaxPool:
      return lower_max_pool(state, node);
    case Operator::kMul:
      return lower_mul(state, node);
    case Operator::kQuantizeLinear:
      return lower_quantize(state, node);
    case Operator::kReduceSum:
      return lower_reduce_sum(state, node);
    case Operator::kRelu:
      return lower_relu(state, node);
    case Operator::kResize:
      return lower_resize(state, node);
    case Operator::kConstant:
    case Operator::kDepthToSpace:
    case Operator::kIdentity:
    case Operator::kReshape:
    case Operator::kSpaceToDepth:
    case Operator::kTranspose:
      return lower_layout(state, node);
  }
}

void lower_output(LoweringState& state, const Port& port) {
  const Symbol* symbol = state.find(port.name);
  const auto* activation = symbol == nullptr ? nullptr : std::get_if<Activation>(symbol);
  if (activation == nullptr || !activation->is_real) {
    refuse("output '{}' is not an activation of real values", port.name);
  }
  if (activation->layout.shape() != port.shape) {
    refuse("output '{}' says its shape is {}, but it is {}", port.name, to_string(port.shape),
           to_string(activation->layout.shape()));
  }
  Node as_node;
  as_node.label = fmt::format("output '{}'", port.name);
  const int value = state.materialize(as_node, *activation);
  state.program().outputs.push_back({port.name, value, port.shape});
}

}  // namespace

Program lower(const Graph& graph) {
  LoweringState state(graph);
  for (const Node& node : graph.nodes) {
    if (node.inputs.empty()) refuse("{} has no input", node.label);
    lower_node(state, node);
  }
  for (const Port& output : graph.outputs) lower_output(state, output);
  for (const ProgramPort& input : state.program().inputs) {
    if (state.value(input.value).scale == 0.0F) {
      refuse("input '{}' is never dequantized", input.name);
    }
  }
  return std::move(state.program());
}

}  // namespace bevloc::nn
