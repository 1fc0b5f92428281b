// A convolution step as a oneDNN primitive: bias, sum, ReLU and rounding inside.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/program.h"

namespace bevloc::nn::onednn {

dnnl::memory::data_type onednn_type(ElementType type);

template <size_t N>
dnnl::memory::dims to_dims(const std::array<int64_t, N>& numbers) {
  return {numbers.begin(), numbers.end()};
}

/// Attributes of a primitive that works in memory made at load. Copies of them would share state.
dnnl::primitive_attr own_scratchpad();

struct Convolution {
  dnnl::convolution_forward::primitive_desc primitive_desc;
  /// What is to be added to the input's elements. CPUs that have no exact product of signed by
  /// signed bytes take int8 as uint8 moved up by 128.
  int input_offset = 0;
  /// Weights and bias in the layout that the primitive wants.
  std::vector<std::pair<int, dnnl::memory>> constants;
};

/// oneDNN chooses all layouts. The residual, if any, is to be put into the destination beforehand:
/// as its own elements if they are as wide as the output's, as real values otherwise.
Convolution make_convolution(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual, const dnnl::engine& engine);

}  // namespace bevloc::nn::onednn
