// Makes the oneDNN primitive of a convolution step, including bias, sum, ReLU and rounding.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/model/program.h"

namespace bevloc::nn::onednn {

dnnl::memory::data_type onednn_type(ElementType type);

template <size_t N>
dnnl::memory::dims to_dims(const std::array<int64_t, N>& numbers) {
  return {numbers.begin(), numbers.end()};
}

/// Attributes of a primitive whose scratchpad the engine provides. Copies of attributes share
/// state, so this makes new ones.
dnnl::primitive_attr own_scratchpad();

struct Convolution {
  dnnl::convolution_forward::primitive_desc primitive_desc;
  /// What must be added to the elements of the input, to convert them to uint8: 128 for an int8
  /// input on CPUs without exact products of int8 by int8, otherwise 0.
  int input_offset = 0;
  /// Weights and bias, by argument index, in the layout that the primitive expects.
  std::vector<std::pair<int, dnnl::memory>> constants;
};

/// oneDNN chooses all layouts. `residual` may be null; otherwise the destination must contain the
/// residual before the primitive runs: its elements if they have the size of the output's elements,
/// its real values otherwise.
Convolution make_convolution(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual, const dnnl::engine& engine);

}  // namespace bevloc::nn::onednn
