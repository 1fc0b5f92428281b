#include "pipeline/network/model/lowering_quantization.h"

#include "pipeline/network/model/limits.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

/// The scales of a (De)QuantizeLinear node. They must be positive, and all zero points must be 0.
std::vector<float> checked_scales(const LoweringState& state, const Node& node) {
  const std::vector<float> scales = state.constant_input(node, 1, "scale").floats();
  for (const float scale : scales) {
    if (!(scale >= kSmallestScale && scale <= kLargestScale)) {
      refuse("{}: scale is {:g}, wanted {:g} to {:g}", node.label, scale, kSmallestScale,
             kLargestScale);
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
  if (scales.size() != 1) refuse("{}: found {} scales, wanted one", node.label, scales.size());
  return scales[0];
}

void dequantize_constant(LoweringState& state, const Node& node, const Tensor& elements) {
  const std::vector<float> scales = checked_scales(state, node);
  if (elements.type == ElementType::kFloat32 || elements.type == ElementType::kInt64) {
    refuse("{}: the constant is {}, wanted int8, uint8 or int32", node.label,
           name_of(elements.type));
  }
  state.spend(static_cast<int64_t>(elements.bytes.size()), node.label);
  const int64_t axis = node.integer("axis", 1);
  const bool per_channel = axis == 0 && !elements.shape.empty() &&
                           static_cast<int64_t>(scales.size()) == elements.shape[0];
  if (scales.size() != 1 && !per_channel) {
    refuse("{}: {} scales along axis {} of shape {}, wanted one or one per channel along axis 0",
           node.label, scales.size(), axis, to_string(elements.shape));
  }
  state.define(node.output, QuantizedConstant{elements, scales});
}

/// Makes the step that computes the activation round its own result. Returns false if it cannot.
bool fold_quantize(LoweringState& state, const Node& node, const Activation& input,
                   ElementType type, float scale) {
  Step* step = state.foldable_step(node.inputs[0], input);
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

}  // namespace

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

void lower_quantize(LoweringState& state, const Node& node) {
  const Activation input = state.real_activation(node, 0);
  const float scale = single_scale(state, node);
  const ElementType type =
      node.has_input(2) ? state.constant_input(node, 2, "zero point").type : ElementType::kUint8;
  if (!is_8_bit(type)) refuse("{}: type is {}, wanted uint8 or int8", node.label, name_of(type));
  const Value value = state.value(input.value);
  int output = input.value;
  if ((value.type != type || value.scale != scale) &&
      !fold_quantize(state, node, input, type, scale)) {
    output = state.add_value(value.dims, type, scale);
    state.program().steps.push_back(ConvertStep{input.value, output});
  }
  state.define_alias(node, Activation{output, input.layout, false});
}

}  // namespace bevloc::nn
