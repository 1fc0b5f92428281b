#include "pipeline/network/model/lowering.h"

#include <algorithm>

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/lowering_quantization.h"
#include "pipeline/network/model/lowering_state.h"
#include "pipeline/network/model/lowering_view.h"
#include "pipeline/network/model/lowering_window.h"

namespace bevloc::nn {
namespace {

/// Whether a Resize node by the factor 2 computes what an UpsampleStep computes.
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
  const Value source = state.value(upsample.input);
  upsample.output = state.define_value(node, output, source.type, source.scale);
  state.program().steps.push_back(upsample);
}

/// Makes the convolution that computes input i add `residual`. Returns false if it cannot.
bool fold_add(LoweringState& state, const Node& node, size_t i, int residual) {
  const Activation& activation = state.real_activation(node, i);
  Step* step = state.foldable_step(node.inputs[i], activation);
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
  if (dims != state.value(right).dims) refuse("{}: the inputs have different shapes", node.label);
  if (left != right && (fold_add(state, node, 1, left) || fold_add(state, node, 0, right))) return;
  const int output = state.add_value(dims);
  state.define(node.output, Activation{output, state.real_activation(node, 0).layout});
  state.program().steps.push_back(AddStep{left, right, output});
}

void lower_relu(LoweringState& state, const Node& node) {
  const Activation input = state.real_activation(node, 0);
  Step* step = state.foldable_step(node.inputs[0], input);
  if (auto* conv = step == nullptr ? nullptr : std::get_if<ConvStep>(step)) {
    conv->relu = true;
    return state.define_alias(node, input);
  }
  if (auto* add = step == nullptr ? nullptr : std::get_if<AddStep>(step)) {
    add->relu = true;
    return state.define_alias(node, input);
  }
  const Value value = state.value(input.value);
  // uint8 has no negative elements.
  if (value.type == ElementType::kUint8) return state.define_alias(node, input);
  const int output = state.add_value(value.dims, value.type, value.scale);
  state.program().steps.push_back(ReluStep{input.value, output});
  state.define(node.output, Activation{output, input.layout});
}

void lower_concat(LoweringState& state, const Node& node) {
  ConcatStep concat;
  for (size_t i = 0; i < node.inputs.size(); ++i) {
    const size_t axes = state.real_activation(node, i).layout.shape().size();
    if (axes != 4) refuse("{}: found an input with {} axes, wanted 4", node.label, axes);
    concat.inputs.push_back(state.materialized_input(node, i));
  }
  if (node.integer("axis", 0) != 1 || concat.inputs.empty()) {
    refuse("{}: wanted inputs along axis 1, the channels", node.label);
  }
  const Value first = state.value(concat.inputs[0]);
  std::array<int64_t, 4> dims = first.dims;
  dims[1] = 0;
  bool alike = true;
  for (const int id : concat.inputs) {
    const Value& input = state.value(id);
    const auto& d = input.dims;
    if (d[0] != dims[0] || d[2] != dims[2] || d[3] != dims[3]) {
      refuse("{}: the inputs differ in more than their channels", node.label);
    }
    dims[1] += d[1];
    alike = alike && input.type == first.type && input.scale == first.scale;
  }
  if (!alike) {  // then the parts must be real values
    for (int& input : concat.inputs) input = state.as_float(input);
  }
  const Value part = state.value(concat.inputs[0]);
  concat.output = state.define_value(node, dims, part.type, part.scale);
  state.program().steps.push_back(concat);
}

void lower_layout(LoweringState& state, const Node& node) {
  const Symbol& input = state.symbol(node, 0);
  if (const auto* activation = std::get_if<Activation>(&input)) {
    Activation moved = *activation;
    moved.layout = traced_through(activation->layout, node, state.graph().constants);
    state.spend(element_count(moved.layout.shape()), node.label);
    state.define_alias(node, std::move(moved));
  } else if (const auto* port = std::get_if<ViewPort>(&input)) {
    state.spend(element_count(port->layout.shape()), node.label);
    state.define(node.output, ViewPort{port->is_weight, traced_through(port->layout, node,
                                                                       state.graph().constants)});
  } else {
    refuse("{}: the input is neither an activation nor the view table", node.label);
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
    refuse("output '{}' is declared with shape {}, but computed with shape {}", port.name,
           to_string(port.shape), to_string(activation->layout.shape()));
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
