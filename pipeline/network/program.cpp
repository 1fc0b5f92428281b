#include "pipeline/network/program.h"

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

std::vector<int> inputs_of(const Step& step) {
  return std::visit([](const auto& known) { return inputs_of_step(known); }, step);
}

int output_of(const Step& step) {
  return std::visit([](const auto& known) { return known.output; }, step);
}

}  // namespace bevloc::nn
