#include "pipeline/network/model/program.h"

namespace bevloc::nn {
namespace {

std::vector<int> inputs_of_step(const ConvStep& step) {
  if (step.residual < 0) return {step.input};
  return {step.input, step.residual};
}

std::vector<int> inputs_of_step(const AddStep& step) {
  return {step.left, step.right};
}

std::vector<int> inputs_of_step(const ConcatStep& step) {
  return step.inputs;
}

template <typename OneInput>
std::vector<int> inputs_of_step(const OneInput& step) {
  return {step.input};
}

}  // namespace

uint64_t element_count(const Value& value) {
  uint64_t count = 1;
  for (const int64_t dim : value.dims) count *= static_cast<uint64_t>(dim);
  return count;
}

uint64_t size_in_bytes(const Value& value) {
  return element_count(value) * size_in_bytes(value.type);
}

std::span<const int8_t> int8_weights(const ConvStep& step) {
  return {reinterpret_cast<const int8_t*>(step.weights.bytes.data()), step.weights.bytes.size()};
}

std::vector<int> inputs_of(const Step& step) {
  return std::visit([](const auto& known) { return inputs_of_step(known); }, step);
}

int output_of(const Step& step) {
  return std::visit([](const auto& known) { return known.output; }, step);
}

std::vector<bool> needed_values(const Program& program, const std::string& output) {
  std::vector<bool> needed(program.values.size(), false);
  for (const ProgramPort& port : program.outputs) {
    if (port.name == output) needed[static_cast<size_t>(port.value)] = true;
  }
  for (auto step = program.steps.rbegin(); step != program.steps.rend(); ++step) {
    if (!needed[static_cast<size_t>(output_of(*step))]) continue;
    for (const int input : inputs_of(*step)) needed[static_cast<size_t>(input)] = true;
  }
  return needed;
}

}  // namespace bevloc::nn
