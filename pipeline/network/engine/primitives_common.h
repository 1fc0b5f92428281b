// What primitives_v2.cpp and primitives_v3.cpp share.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/network/engine/primitives.h"

namespace bevloc::nn::onednn {

/// Attributes of a primitive whose scratchpad the engine provides. Copies of attributes share
/// state, so this makes new ones.
dnnl::primitive_attr own_scratchpad();

template <typename Made>
Primitive primitive_of(const typename Made::primitive_desc& desc, Constants constants = {}) {
  return {Made(desc), desc.scratchpad_desc().get_size(), std::move(constants)};
}

/// The layouts of a convolution, and the offset of its input.
struct ConvolutionLayouts {
  MemoryDesc source;
  MemoryDesc weights;
  MemoryDesc bias;  ///< empty without a bias
  MemoryDesc destination;
  dnnl::memory::dims dilations;
  int input_offset = 0;

  ConvolutionLayouts(const ConvStep& step, const Value& input, const Value& output);
};

/// Whether the convolution must cut negative values. Rounding to uint8 already removes them.
bool cuts_negative_values(const ConvStep& step, const Value& output);

/// The real value of one unit of the accumulator in units of the output, by output channel. It is
/// empty for float weights.
std::vector<float> output_scales(const ConvStep& step, const Value& input, const Value& output);

/// The bias in units of `scale`, by output channel.
std::vector<float> bias_in_units(const ConvStep& step, const std::vector<float>& scale);

/// The weights in oneDNN's memory, in the layout `wanted`.
dnnl::memory weights_in(const ConvStep& step, const MemoryDesc& wanted, const dnnl::engine& engine);

/// A copy of the elements in oneDNN's memory.
template <typename Element>
dnnl::memory constant(const std::vector<Element>& elements, dnnl::memory::data_type type,
                      const dnnl::engine& engine) {
  const auto count = static_cast<dnnl::memory::dim>(elements.size());
  dnnl::memory memory({{count}, type, dnnl::memory::format_tag::a}, engine);
  std::ranges::copy(elements, static_cast<Element*>(memory.get_data_handle()));
  return memory;
}

}  // namespace bevloc::nn::onednn
