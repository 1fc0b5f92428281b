// The primitives for version 2 of oneDNN: scales and offsets are attributes.
#include "pipeline/network/engine/primitives_common.h"

namespace bevloc::nn::onednn {
namespace {

constexpr auto kForward = dnnl::prop_kind::forward_inference;

dnnl::primitive_attr conv_attributes(const ConvStep& step, const Value& input, const Value& output,
                                     const Value* residual) {
  dnnl::primitive_attr attributes = own_scratchpad();
  const std::vector<float> scales = output_scales(step, input, output);
  constexpr int kPerOutputChannel = 1 << 1;
  if (!scales.empty()) attributes.set_output_scales(kPerOutputChannel, scales);
  dnnl::post_ops post_ops;
  if (residual != nullptr) {
    const bool same_width = size_in_bytes(residual->type) == size_in_bytes(output.type);
    post_ops.append_sum((same_width ? residual->scale : 1.0F) / output.scale,
                        onednn_type(same_width ? residual->type : output.type));
  }
  if (cuts_negative_values(step, output)) {
    post_ops.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
  }
  attributes.set_post_ops(post_ops);
  return attributes;
}

}  // namespace

dnnl::memory::dims dims_of(const MemoryDesc& desc) {
  return desc.dims();
}

dnnl::memory::dims strides_of(const MemoryDesc& desc) {
  const auto& strides = desc.data.format_desc.blocking.strides;
  return {strides, strides + desc.data.ndims};
}

Primitive make_copy(const MemoryDesc& from, const MemoryDesc& to, Conversion conversion,
                    const dnnl::engine& engine) {
  dnnl::primitive_attr attributes = own_scratchpad();
  if (conversion.scale != 1.0F) attributes.set_output_scales(0, {conversion.scale});
  if (conversion.offset != 0) attributes.set_zero_points(DNNL_ARG_DST, 0, {conversion.offset});
  return primitive_of<dnnl::reorder>({engine, from, engine, to, attributes});
}

Primitive make_max_pool(const MaxPoolStep& step, const MemoryDesc& from, const MemoryDesc& to,
                        const dnnl::engine& engine) {
  return primitive_of<dnnl::pooling_forward>({{kForward,
                                               dnnl::algorithm::pooling_max,
                                               from,
                                               to,
                                               to_dims(step.strides),
                                               to_dims(step.kernel),
                                               {step.pads[0], step.pads[1]},
                                               {step.pads[2], step.pads[3]}},
                                              own_scratchpad(),
                                              engine});
}

Primitive make_upsample(const UpsampleStep& step, const MemoryDesc& from, const MemoryDesc& to,
                        const dnnl::engine& engine) {
  const auto algorithm =
      step.linear ? dnnl::algorithm::resampling_linear : dnnl::algorithm::resampling_nearest;
  return primitive_of<dnnl::resampling_forward>(
      {{kForward, algorithm, from, to}, own_scratchpad(), engine});
}

Primitive make_sum(const MemoryDesc& left, const MemoryDesc& right, const MemoryDesc& to,
                   std::array<float, 2> scales, bool relu, const dnnl::engine& engine) {
  dnnl::primitive_attr attributes = own_scratchpad();
  attributes.set_scales(DNNL_ARG_SRC_0, 0, {scales[0]});
  attributes.set_scales(DNNL_ARG_SRC_1, 0, {scales[1]});
  if (relu) {
    dnnl::post_ops post_ops;
    post_ops.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
    attributes.set_post_ops(post_ops);
  }
  return primitive_of<dnnl::binary>(
      {{dnnl::algorithm::binary_add, left, right, to}, attributes, engine});
}

Primitive make_relu(const MemoryDesc& layout, const dnnl::engine& engine) {
  return primitive_of<dnnl::eltwise_forward>(
      {{kForward, dnnl::algorithm::eltwise_relu, layout, 0.0F, 0.0F}, own_scratchpad(), engine});
}

Primitive make_concat(const std::vector<MemoryDesc>& from, const MemoryDesc& to,
                      const dnnl::engine& engine) {
  return primitive_of<dnnl::concat>({to, 1, from, engine, own_scratchpad()});
}

Convolution make_convolution(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual, const dnnl::engine& engine) {
  const ConvolutionLayouts layouts(step, input, output);
  dnnl::primitive_attr attributes = conv_attributes(step, input, output, residual);
  if (layouts.input_offset != 0) {
    attributes.set_zero_points(DNNL_ARG_SRC, 0, {layouts.input_offset});
  }
  const dnnl::convolution_forward::primitive_desc desc({kForward,
                                                        dnnl::algorithm::convolution_direct,
                                                        layouts.source,
                                                        layouts.weights,
                                                        layouts.bias,
                                                        layouts.destination,
                                                        to_dims(step.strides),
                                                        layouts.dilations,
                                                        {step.pads[0], step.pads[1]},
                                                        {step.pads[2], step.pads[3]}},
                                                       attributes, engine);
  Constants constants{{DNNL_ARG_WEIGHTS, weights_in(step, desc.weights_desc(), engine)}};
  if (!step.bias.empty()) {
    // The bias is added before the scale.
    std::vector<float> scale = step.weight_scale;
    for (float& s : scale) s *= input.scale;
    constants.emplace_back(
        DNNL_ARG_BIAS, constant(bias_in_units(step, scale), dnnl::memory::data_type::f32, engine));
  }
  return {primitive_of<dnnl::convolution_forward>(desc, std::move(constants)), layouts.source,
          layouts.destination, layouts.input_offset};
}

}  // namespace bevloc::nn::onednn
