// The primitives for version 3 of oneDNN: scales and offsets are arguments, and the attributes only
// say that they exist.
#include "pipeline/network/engine/primitives_common.h"

namespace bevloc::nn::onednn {
namespace {

using Type = dnnl::memory::data_type;

constexpr auto kForward = dnnl::prop_kind::forward_inference;

/// Attributes of a primitive and the arguments that belong to them.
class Attributes {
 public:
  explicit Attributes(const dnnl::engine& engine) : engine_(engine) {}

  /// Multiplies an argument. Bit i of `mask` says that the scale differs along axis i.
  void scale(int argument, int mask, const std::vector<float>& scales) {
    attributes_.set_scales_mask(argument, mask);
    constants_.emplace_back(DNNL_ARG_ATTR_SCALES | argument, constant(scales, Type::f32, engine_));
  }
  void zero_point(int argument, int32_t zero) {
    attributes_.set_zero_points_mask(argument, 0);
    constants_.emplace_back(DNNL_ARG_ATTR_ZERO_POINTS | argument,
                            constant(std::vector<int32_t>{zero}, Type::s32, engine_));
  }
  void post_ops(const dnnl::post_ops& post_ops) { attributes_.set_post_ops(post_ops); }

  const dnnl::primitive_attr& attributes() const { return attributes_; }
  Constants& constants() { return constants_; }

 private:
  const dnnl::engine& engine_;
  dnnl::primitive_attr attributes_ = own_scratchpad();
  Constants constants_;
};

dnnl::post_ops conv_post_ops(const ConvStep& step, const Value& output, const Value* residual) {
  dnnl::post_ops post_ops;
  if (residual != nullptr) {
    const bool same_width = size_in_bytes(residual->type) == size_in_bytes(output.type);
    post_ops.append_sum((same_width ? residual->scale : 1.0F) / output.scale, 0,
                        onednn_type(same_width ? residual->type : output.type));
  }
  if (cuts_negative_values(step, output)) {
    post_ops.append_eltwise(dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
  }
  return post_ops;
}

}  // namespace

dnnl::memory::dims dims_of(const MemoryDesc& desc) {
  return desc.get_dims();
}

dnnl::memory::dims strides_of(const MemoryDesc& desc) {
  return desc.get_strides();
}

Primitive make_copy(const MemoryDesc& from, const MemoryDesc& to, Conversion conversion,
                    const dnnl::engine& engine) {
  Attributes attributes(engine);
  if (conversion.scale != 1.0F) attributes.scale(DNNL_ARG_FROM, 0, {conversion.scale});
  if (conversion.offset != 0) attributes.zero_point(DNNL_ARG_TO, conversion.offset);
  return primitive_of<dnnl::reorder>({engine, from, engine, to, attributes.attributes()},
                                     std::move(attributes.constants()));
}

Primitive make_max_pool(const MaxPoolStep& step, const MemoryDesc& from, const MemoryDesc& to,
                        const dnnl::engine& engine) {
  return primitive_of<dnnl::pooling_forward>({engine,
                                              kForward,
                                              dnnl::algorithm::pooling_max,
                                              from,
                                              to,
                                              to_dims(step.strides),
                                              to_dims(step.kernel),
                                              {0, 0},
                                              {step.pads[0], step.pads[1]},
                                              {step.pads[2], step.pads[3]},
                                              own_scratchpad()});
}

Primitive make_upsample(const UpsampleStep& step, const MemoryDesc& from, const MemoryDesc& to,
                        const dnnl::engine& engine) {
  const auto algorithm =
      step.linear ? dnnl::algorithm::resampling_linear : dnnl::algorithm::resampling_nearest;
  return primitive_of<dnnl::resampling_forward>(
      {engine, kForward, algorithm, from, to, own_scratchpad()});
}

Primitive make_sum(const MemoryDesc& left, const MemoryDesc& right, const MemoryDesc& to,
                   std::array<float, 2> scales, bool relu, const dnnl::engine& engine) {
  Attributes attributes(engine);
  attributes.scale(DNNL_ARG_SRC_0, 0, {scales[0]});
  attributes.scale(DNNL_ARG_SRC_1, 0, {scales[1]});
  if (relu) {
    dnnl::post_ops post_ops;
    post_ops.append_eltwise(dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
    attributes.post_ops(post_ops);
  }
  return primitive_of<dnnl::binary>(
      {engine, dnnl::algorithm::binary_add, left, right, to, attributes.attributes()},
      std::move(attributes.constants()));
}

Primitive make_relu(const MemoryDesc& layout, const dnnl::engine& engine) {
  return primitive_of<dnnl::eltwise_forward>({engine, kForward, dnnl::algorithm::eltwise_relu,
                                              layout, layout, 0.0F, 0.0F, own_scratchpad()});
}

Primitive make_concat(const std::vector<MemoryDesc>& from, const MemoryDesc& to,
                      const dnnl::engine& engine) {
  return primitive_of<dnnl::concat>({engine, to, 1, from, own_scratchpad()});
}

Convolution make_convolution(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual, const dnnl::engine& engine) {
  const ConvolutionLayouts layouts(step, input, output);
  Attributes attributes(engine);
  const std::vector<float> scales = output_scales(step, input, output);
  const int per_output_channel = step.groups > 1 ? 1 << 0 | 1 << 1 : 1 << 0;
  if (!scales.empty()) attributes.scale(DNNL_ARG_WEIGHTS, per_output_channel, scales);
  if (layouts.input_offset != 0) attributes.zero_point(DNNL_ARG_SRC, layouts.input_offset);
  attributes.post_ops(conv_post_ops(step, output, residual));
  const dnnl::convolution_forward::primitive_desc desc(
      engine, kForward, dnnl::algorithm::convolution_direct, layouts.source, layouts.weights,
      layouts.bias, layouts.destination, to_dims(step.strides), layouts.dilations,
      {step.pads[0], step.pads[1]}, {step.pads[2], step.pads[3]}, attributes.attributes());
  Constants& constants = attributes.constants();
  constants.emplace_back(DNNL_ARG_WEIGHTS, weights_in(step, desc.weights_desc(), engine));
  if (!step.bias.empty()) {
    // The bias is added after the scale.
    const std::vector<float> units(scales.size(), output.scale);
    constants.emplace_back(DNNL_ARG_BIAS, constant(bias_in_units(step, units), Type::f32, engine));
  }
  return {primitive_of<dnnl::convolution_forward>(desc, std::move(constants)), layouts.source,
          layouts.destination, layouts.input_offset};
}

}  // namespace bevloc::nn::onednn
