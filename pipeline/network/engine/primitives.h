// The oneDNN primitives of a plan. How a primitive is made and scaled differs between version 2 of
// oneDNN (Debian 12) and version 3 (Debian 13): the build takes primitives_v2.cpp or
// primitives_v3.cpp. All layouts are plain: without blocks of channels.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/model/program.h"

namespace bevloc::nn::onednn {

using MemoryDesc = dnnl::memory::desc;

/// Arguments of a primitive that do not change, by argument index.
using Constants = std::vector<std::pair<int, dnnl::memory>>;

struct Primitive {
  dnnl::primitive primitive;
  size_t scratchpad_bytes = 0;  ///< the engine provides it
  Constants constants;
};

/// What a copy does to each element: element * scale + offset, in the units of the target.
struct Conversion {
  float scale = 1.0F;
  int offset = 0;
};

Primitive make_copy(const MemoryDesc& from, const MemoryDesc& to, Conversion conversion,
                    const dnnl::engine& engine);
Primitive make_max_pool(const MaxPoolStep& step, const MemoryDesc& from, const MemoryDesc& to,
                        const dnnl::engine& engine);
Primitive make_upsample(const UpsampleStep& step, const MemoryDesc& from, const MemoryDesc& to,
                        const dnnl::engine& engine);
/// to = left * scales[0] + right * scales[1], then ReLU if `relu` is set.
Primitive make_sum(const MemoryDesc& left, const MemoryDesc& right, const MemoryDesc& to,
                   std::array<float, 2> scales, bool relu, const dnnl::engine& engine);
Primitive make_relu(const MemoryDesc& layout, const dnnl::engine& engine);
/// Joins along the channels.
Primitive make_concat(const std::vector<MemoryDesc>& from, const MemoryDesc& to,
                      const dnnl::engine& engine);

struct Convolution {
  Primitive primitive;
  MemoryDesc source;
  MemoryDesc destination;
  /// What must be added to the elements of the input, to convert them to uint8: 128 for an int8
  /// input on CPUs without exact products of int8 by int8, otherwise 0.
  int input_offset = 0;
};

/// Input and output are channel-last. `residual` may be null; otherwise the destination must
/// contain the residual before the primitive runs: its elements if they have the size of the
/// output's elements, its real values otherwise.
Convolution make_convolution(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual, const dnnl::engine& engine);

dnnl::memory::data_type onednn_type(ElementType type);
dnnl::memory::dims strides_of(const MemoryDesc& desc);
dnnl::memory::dims dims_of(const MemoryDesc& desc);
/// The layout with another element type.
MemoryDesc with_type(const MemoryDesc& desc, ElementType type);

template <size_t N>
dnnl::memory::dims to_dims(const std::array<int64_t, N>& numbers) {
  return {numbers.begin(), numbers.end()};
}

}  // namespace bevloc::nn::onednn
