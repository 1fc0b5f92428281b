#include "pipeline/network/engines/onednn/convolution.h"

#include <algorithm>
#include <cassert>

#include "pipeline/network/engines/onednn/isa.h"

namespace bevloc::nn::onednn {
namespace {

using Tag = dnnl::memory::format_tag;
using Desc = dnnl::memory::desc;

constexpr int kSignOffset = 128;

/// Real value of one unit of the accumulator, by output channel. Empty for float weights.
std::vector<float> accumulator_scale(const ConvStep& step, const Value& input) {
  std::vector<float> scale = step.weight_scale;
  for (float& s : scale) s *= input.scale;
  return scale;
}

dnnl::primitive_attr attributes(const ConvStep& step, const Value& input, const Value& output,
                                const Value* residual) {
  dnnl::primitive_attr attributes = own_scratchpad();
  std::vector<float> scale = accumulator_scale(step, input);
  if (!scale.empty()) {
    for (float& s : scale) s /= output.scale;
    constexpr int kPerOutputChannel = 1 << 1;
    attributes.set_output_scales(kPerOutputChannel, scale);
  }
  dnnl::post_ops post_ops;
  if (residual != nullptr) {
    const bool same_width = size_in_bytes(residual->type) == size_in_bytes(output.type);
    if (same_width) {
      post_ops.append_sum(residual->scale / output.scale, onednn_type(residual->type));
    } else {
      post_ops.append_sum(1.0F / output.scale, onednn_type(output.type));
    }
  }
  // Rounding to uint8 already removes negative values.
  if (step.relu && output.type != ElementType::kUint8) {
    post_ops.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
  }
  attributes.set_post_ops(post_ops);
  return attributes;
}

/// [out, in, rows, cols], or, with several groups, [groups, out / groups, in / groups, rows, cols].
dnnl::memory::dims weight_dims(const ConvStep& step) {
  dnnl::memory::dims dims = step.weights.shape;
  if (step.groups > 1) {
    dims[0] /= step.groups;
    dims.insert(dims.begin(), step.groups);
  }
  return dims;
}

/// A copy of `data` in oneDNN's memory, in the layout `to`.
dnnl::memory reordered(const Desc& from, const void* data, const Desc& to,
                       const dnnl::engine& engine) {
  // oneDNN takes a mutable pointer, but does not write to the source.
  dnnl::memory source(from, engine, const_cast<void*>(data));
  dnnl::memory destination(to, engine);
  dnnl::stream stream(engine);
  dnnl::reorder(source, destination).execute(stream, source, destination);
  stream.wait();
  return destination;
}

dnnl::memory weights(const ConvStep& step, const Desc& wanted, const dnnl::engine& engine) {
  const Desc plain(weight_dims(step), onednn_type(step.weights.type),
                   step.groups > 1 ? Tag::goihw : Tag::oihw);
  return reordered(plain, step.weights.bytes.data(), wanted, engine);
}

dnnl::memory bias(const ConvStep& step, const Value& input, const Desc& wanted,
                  const dnnl::engine& engine) {
  std::vector<float> in_accumulator_units = step.bias;
  const std::vector<float> scale = accumulator_scale(step, input);
  for (size_t i = 0; i < scale.size(); ++i) in_accumulator_units[i] /= scale[i];
  return reordered(wanted, in_accumulator_units.data(), wanted, engine);
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

Convolution make_convolution(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual, const dnnl::engine& engine) {
  Convolution convolution;
  const bool offset = input.type == ElementType::kInt8 && !has_exact_int8_products();
  convolution.input_offset = offset ? kSignOffset : 0;
  const Desc source(to_dims(input.dims), onednn_type(offset ? ElementType::kUint8 : input.type),
                    Tag::any);
  const Desc weight(weight_dims(step), onednn_type(step.weights.type), Tag::any);
  const Desc destination(to_dims(output.dims), onednn_type(output.type), Tag::any);
  const bool has_bias = !step.bias.empty();
  const Desc bias_desc =
      has_bias ? Desc({output.dims[1]}, dnnl::memory::data_type::f32, Tag::a) : Desc();
  const dnnl::memory::dims dilations{step.dilations[0] - 1, step.dilations[1] - 1};
  const dnnl::convolution_forward::desc desc(
      dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct, source, weight,
      bias_desc, destination, to_dims(step.strides), dilations, {step.pads[0], step.pads[1]},
      {step.pads[2], step.pads[3]});

  dnnl::primitive_attr attribute = attributes(step, input, output, residual);
  if (offset) attribute.set_zero_points(DNNL_ARG_SRC, 0, {kSignOffset});
  convolution.primitive_desc = {desc, attribute, engine};
  const auto& pd = convolution.primitive_desc;
  convolution.constants.emplace_back(DNNL_ARG_WEIGHTS, weights(step, pd.weights_desc(), engine));
  if (has_bias) {
    convolution.constants.emplace_back(DNNL_ARG_BIAS, bias(step, input, pd.bias_desc(), engine));
  }
  return convolution;
}

}  // namespace bevloc::nn::onednn
