#include "pipeline/network/model/lowering_state.h"

#include <algorithm>

#include "pipeline/network/model/limits.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

/// The shape with leading axes of length 1, so that it has four axes.
std::array<int64_t, 4> padded_dims(const Shape& shape, const std::string& what) {
  if (shape.size() > 4) refuse("{} has shape {}, wanted at most 4 axes", what, to_string(shape));
  std::array<int64_t, 4> dims{1, 1, 1, 1};
  std::ranges::copy_backward(shape, dims.end());
  return dims;
}

}  // namespace

std::vector<float> QuantizedConstant::real_values() const {
  std::vector<float> values = elements.floats();
  const size_t per_scale = values.size() / scale.size();
  for (size_t i = 0; i < values.size(); ++i) values[i] *= scale[i / per_scale];
  return values;
}

LoweringState::LoweringState(const Graph& graph) : graph_(graph) {
  for (const Node& node : graph.nodes) {
    for (const std::string& input : node.inputs) ++use_count_[input];
  }
  for (const Port& output : graph.outputs) ++use_count_[output.name];
  for (const Port& input : graph.inputs) {
    if (input.name == kViewIndexPort || input.name == kViewWeightPort) {
      define(input.name, ViewPort{input.name == kViewWeightPort, LayoutTrace(input.shape)});
      continue;
    }
    const bool real = input.type == ElementType::kFloat32;
    if (!real && !is_8_bit(input.type)) {
      refuse("input '{}' is {}, wanted float, uint8 or int8", input.name, name_of(input.type));
    }
    const int id = add_value(padded_dims(input.shape, fmt::format("input '{}'", input.name)),
                             input.type, real ? 1.0F : 0.0F);
    define(input.name, Activation{id, LayoutTrace(input.shape), real});
    program_.inputs.push_back({input.name, id, input.shape});
  }
}

void LoweringState::spend(int64_t elements, const std::string& what) {
  elements_ += elements;
  if (elements_ > kMostElementsTogether) {
    refuse("{}: the model needs more than {} elements, wanted a smaller model", what,
           kMostElementsTogether);
  }
}

int LoweringState::add_value(const std::array<int64_t, 4>& dims, ElementType type, float scale) {
  const std::string what = fmt::format("value {}", program_.values.size());
  spend(checked_element_count({dims.begin(), dims.end()}, what), what);
  program_.values.push_back({dims, type, scale});
  return static_cast<int>(program_.values.size()) - 1;
}

int LoweringState::define_value(const Node& node, const std::array<int64_t, 4>& dims,
                                ElementType type, float scale) {
  const int id = add_value(dims, type, scale);
  define(node.output, Activation{id, LayoutTrace({dims.begin(), dims.end()})});
  return id;
}

void LoweringState::define_alias(const Node& node, Symbol symbol) {
  use_count_[node.output] += use_count_[node.inputs[0]] - 1;
  define(node.output, std::move(symbol));
}

const Symbol* LoweringState::find(const std::string& name) const {
  const auto found = symbols_.find(name);
  return found == symbols_.end() ? nullptr : &found->second;
}

const Tensor* LoweringState::constant(const std::string& name) const {
  const auto found = graph_.constants.find(name);
  return found == graph_.constants.end() ? nullptr : &found->second;
}

const Symbol& LoweringState::symbol(const Node& node, size_t i) const {
  const Symbol* symbol = node.has_input(i) ? find(node.inputs[i]) : nullptr;
  if (symbol == nullptr) {
    refuse("{}: input {} is missing or a constant, wanted an activation", node.label, i);
  }
  return *symbol;
}

const Tensor& LoweringState::constant_input(const Node& node, size_t i, const char* what) const {
  const Tensor* tensor = node.has_input(i) ? constant(node.inputs[i]) : nullptr;
  if (tensor == nullptr) refuse("{}: the {} is missing or not a constant", node.label, what);
  return *tensor;
}

const Activation& LoweringState::real_activation(const Node& node, size_t i) const {
  const auto* activation = std::get_if<Activation>(&symbol(node, i));
  if (activation == nullptr || !activation->is_real) {
    refuse("{}: input {} is not an activation of real values", node.label, i);
  }
  return *activation;
}

int LoweringState::materialize(const Node& node, const Activation& activation) {
  const Shape& shape = activation.layout.shape();
  const std::array<int64_t, 4> dims = padded_dims(shape, node.label);
  Value& source = value(activation.value);
  if (activation.layout.is_identity()) {
    if (dims == source.dims) return activation.value;
    const bool same_planes = dims[0] == source.dims[0] && dims[1] == source.dims[1];
    const Step* producer = producer_of(activation.value);
    const bool any_shape = producer == nullptr || std::holds_alternative<ViewStep>(*producer);
    if (same_planes && any_shape && !is_read(activation.value)) {
      // Nothing depends on the current rows and columns, so the value itself can be reshaped.
      source.dims = dims;
      return activation.value;
    }
  }
  const int copy = add_value(dims, source.type, source.scale);
  program_.steps.push_back(RearrangeStep{activation.value, copy, activation.layout.sources()});
  return copy;
}

int LoweringState::materialized_input(const Node& node, size_t i) {
  const Activation activation = real_activation(node, i);
  const int id = materialize(node, activation);
  define(node.inputs[i], Activation{id, LayoutTrace(activation.layout.shape()), true});
  return id;
}

int LoweringState::as_float(int id) {
  const Value source = value(id);
  if (source.type == ElementType::kFloat32) return id;
  const int converted = add_value(source.dims);
  program_.steps.push_back(ConvertStep{id, converted});
  return converted;
}

Step* LoweringState::foldable_step(const std::string& name, const Activation& activation) {
  const bool only_reader = use_count_.at(name) == 1 && !is_read(activation.value);
  const bool rounded = value(activation.value).type != ElementType::kFloat32;
  if (!only_reader || rounded || !activation.layout.is_identity()) return nullptr;
  return producer_of(activation.value);
}

Step* LoweringState::producer_of(int id) {
  const auto found = std::ranges::find_if(program_.steps,
                                          [id](const Step& step) { return output_of(step) == id; });
  return found == program_.steps.end() ? nullptr : &*found;
}

Step* LoweringState::move_to_end(Step* step) {
  const auto position = program_.steps.begin() + (step - program_.steps.data());
  std::rotate(position, position + 1, program_.steps.end());
  return &program_.steps.back();
}

bool LoweringState::is_read(int id) const {
  return std::ranges::any_of(program_.steps, [id](const Step& step) {
    const std::vector<int> inputs = inputs_of(step);
    return std::ranges::find(inputs, id) != inputs.end();
  });
}

}  // namespace bevloc::nn
