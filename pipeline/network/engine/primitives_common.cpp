#include "pipeline/network/engine/primitives_common.h"

#include <cassert>

#include "pipeline/network/engine/isa.h"

namespace bevloc::nn::onednn {
namespace {

using Tag = dnnl::memory::format_tag;

constexpr int kSignOffset = 128;

/// [out, in, rows, cols], or, with several groups, [groups, out / groups, in / groups, rows, cols].
dnnl::memory::dims weight_dims(const ConvStep& step) {
  dnnl::memory::dims dims = step.weights.shape;
  if (step.groups > 1) {
    dims[0] /= step.groups;
    dims.insert(dims.begin(), step.groups);
  }
  return dims;
}

/// Version 3.7.2 of oneDNN (Debian 13) packs weights wrongly into its blocks if the input has more
/// than 16 channels and their number is no multiple of 16. So it gets a layout without blocks.
Tag weight_layout([[maybe_unused]] int64_t groups) {
#if DNNL_VERSION_MAJOR >= 3
  return groups > 1 ? Tag::hwigo : Tag::hwio;
#else
  return Tag::any;
#endif
}

int input_offset_of(const Value& input) {
  return input.type == ElementType::kInt8 && !has_exact_int8_products() ? kSignOffset : 0;
}

}  // namespace

dnnl::primitive_attr own_scratchpad() {
  dnnl::primitive_attr attributes;
  attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  return attributes;
}

dnnl::memory::data_type onednn_type(ElementType type) {
  switch (type) {
    case ElementType::kUint8:
      return dnnl::memory::data_type::u8;
    case ElementType::kInt8:
      return dnnl::memory::data_type::s8;
    case ElementType::kFloat32:
      return dnnl::memory::data_type::f32;
    case ElementType::kInt32:
    case ElementType::kInt64:
      break;
  }
  assert(false && "activations cannot have this type");
  return dnnl::memory::data_type::undef;
}

MemoryDesc with_type(const MemoryDesc& desc, ElementType type) {
  return {dims_of(desc), onednn_type(type), strides_of(desc)};
}

ConvolutionLayouts::ConvolutionLayouts(const ConvStep& step, const Value& input,
                                       const Value& output)
    : source(to_dims(input.dims),
             onednn_type(input_offset_of(input) != 0 ? ElementType::kUint8 : input.type),
             Tag::acdb),
      weights(weight_dims(step), onednn_type(step.weights.type), weight_layout(step.groups)),
      destination(to_dims(output.dims), onednn_type(output.type), Tag::acdb),
      dilations{step.dilations[0] - 1, step.dilations[1] - 1},
      input_offset(input_offset_of(input)) {
  if (!step.bias.empty()) {
    bias = MemoryDesc({output.dims[1]}, dnnl::memory::data_type::f32, Tag::a);
  }
}

bool cuts_negative_values(const ConvStep& step, const Value& output) {
  return step.relu && output.type != ElementType::kUint8;
}

std::vector<float> output_scales(const ConvStep& step, const Value& input, const Value& output) {
  std::vector<float> scale = step.weight_scale;
  for (float& s : scale) s = s * input.scale / output.scale;
  return scale;
}

std::vector<float> bias_in_units(const ConvStep& step, const std::vector<float>& scale) {
  std::vector<float> bias = step.bias;
  for (size_t i = 0; i < scale.size(); ++i) bias[i] /= scale[i];
  return bias;
}

dnnl::memory weights_in(const ConvStep& step, const MemoryDesc& wanted,
                        const dnnl::engine& engine) {
  const MemoryDesc plain(weight_dims(step), onednn_type(step.weights.type),
                         step.groups > 1 ? Tag::goihw : Tag::oihw);
  // oneDNN takes a mutable pointer, but does not write to the source.
  dnnl::memory source(plain, engine, const_cast<std::byte*>(step.weights.bytes.data()));
  dnnl::memory weights(wanted, engine);
  dnnl::stream stream(engine);
  dnnl::reorder(source, weights).execute(stream, source, weights);
  stream.wait();
  return weights;
}

}  // namespace bevloc::nn::onednn
