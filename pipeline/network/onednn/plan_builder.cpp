#include "pipeline/network/onednn/plan_builder.h"

#include <algorithm>
#include <map>

#include "pipeline/network/onednn/convolution.h"
#include "pipeline/network/onednn/direct_task.h"
#include "pipeline/network/schedule.h"
#include "pipeline/network/storage_plan.h"

namespace bevloc::nn::onednn {
namespace {

using Tag = dnnl::memory::format_tag;

bool is_plain(const MemoryDesc& desc) {
  return desc.data.format_kind == dnnl_blocked && desc.data.format_desc.blocking.inner_nblks == 0;
}

MemoryDesc with_type(const MemoryDesc& desc, ElementType type) {
  MemoryDesc changed = desc;
  changed.data.data_type = dnnl::memory::convert_to_c(onednn_type(type));
  return changed;
}

dnnl::primitive_attr scaled(float scale) {
  dnnl::primitive_attr attributes = own_scratchpad();
  if (scale != 1.0F) attributes.set_output_scales(0, {scale});
  return attributes;
}

/// For each element in row-major order its place in memory.
std::vector<int32_t> places(const MemoryDesc& desc) {
  const auto& dims = desc.data.dims;
  const auto& strides = desc.data.format_desc.blocking.strides;
  std::vector<int32_t> place;
  for (int64_t n = 0; n < dims[0]; ++n) {
    for (int64_t c = 0; c < dims[1]; ++c) {
      for (int64_t h = 0; h < dims[2]; ++h) {
        for (int64_t w = 0; w < dims[3]; ++w) {
          place.push_back(static_cast<int32_t>(n * strides[0] + c * strides[1] + h * strides[2] +
                                               w * strides[3]));
        }
      }
    }
  }
  return place;
}

class PlanBuilder {
 public:
  PlanBuilder(const Program& program, std::span<const Branch> branches, const dnnl::engine& engine,
              const ViewEntries& entries, const KernelSet* kernels);
  ExecutionPlan build();

 private:
  void add(const ConvStep& step);
  void add_direct(const ConvStep& step);
  void add(const MaxPoolStep& step);
  void add(const UpsampleStep& step);
  void add(const AddStep& step);
  void add(const ReluStep& step);
  void add(const ConvertStep& step);
  void add(const RearrangeStep& step);
  void add(const ConcatStep& step);
  void add(const ViewStep& step);
  void add_output(size_t output);

  const Value& value(int id) const { return program_.values[static_cast<size_t>(id)]; }
  MemoryDesc dense(int id, Tag tag) const {
    return {to_dims(value(id).dims), onednn_type(value(id).type), tag};
  }
  const MemoryDesc& desc(int buffer) const { return plan_.buffers[buffer].desc; }

  int new_buffer(const MemoryDesc& desc);
  int new_buffer_in(size_t storage, const MemoryDesc& desc);
  void needed_now(int buffer);
  /// The buffer of a value as its producer left it, or in another layout (a copy, made once).
  int buffer_of(int id) const { return buffer_of_value_[static_cast<size_t>(id)]; }
  void set_buffer_of(int id, int buffer) { buffer_of_value_[static_cast<size_t>(id)] = buffer; }
  int buffer_in(int id, const MemoryDesc& wanted);
  int plain_buffer_of(int id);
  int offset_copy(int id, const MemoryDesc& wanted, int offset);
  int destination_with_residual(const ConvStep& step, const MemoryDesc& wanted);
  bool may_overwrite(int residual) const;

  void add_reorder(int from, const MemoryDesc& from_desc, int to, const MemoryDesc& to_desc,
                   const dnnl::primitive_attr& attributes);
  template <typename PrimitiveDesc>
  void add_primitive(const PrimitiveDesc& primitive_desc, dnnl::primitive primitive,
                     std::vector<PrimitiveTask::BufferArgument> arguments,
                     std::vector<std::pair<int, dnnl::memory>> constants = {});
  void push(std::unique_ptr<Task> task);

  const Program& program_;
  const dnnl::engine& engine_;
  const ViewEntries& entries_;
  const KernelSet* kernels_;  ///< of the convolutions that are not oneDNN's; null for none

  const Schedule schedule_;
  std::vector<int> buffer_of_value_;
  std::map<std::pair<int, size_t>, std::vector<int>> copies_;  ///< by value and branch

  ExecutionPlan plan_;
  StoragePlan storages_;
  size_t position_ = 0;
};

PlanBuilder::PlanBuilder(const Program& program, std::span<const Branch> branches,
                         const dnnl::engine& engine, const ViewEntries& entries,
                         const KernelSet* kernels)
    : program_(program),
      engine_(engine),
      entries_(entries),
      kernels_(kernels),
      schedule_(make_schedule(program, branches)),
      buffer_of_value_(program.values.size(), -1) {
  plan_.branches.resize(branches.size());
}

ExecutionPlan PlanBuilder::build() {
  for (const ProgramPort& input : program_.inputs) {
    const int buffer = new_buffer(dense(input.value, Tag::abcd));
    storages_.keep(plan_.buffers[buffer].storage);
    set_buffer_of(input.value, buffer);
    plan_.input_buffers.push_back(buffer);
  }
  plan_.output_buffers.resize(program_.outputs.size());
  const std::vector<size_t>& order = schedule_.order;
  for (size_t branch = 0; branch < plan_.branches.size(); ++branch) {
    storages_.begin_branch(branch);
    for (; position_ < order.size() && schedule_.branch_of_step[order[position_]] == branch;
         ++position_) {
      std::visit([this](const auto& step) { add(step); }, program_.steps[order[position_]]);
    }
    for (size_t i = 0; i < program_.outputs.size(); ++i) {
      if (schedule_.branch_of_output[i] == branch) add_output(i);
    }
  }
  plan_.storages = storages_.lifetimes();
  return std::move(plan_);
}

int PlanBuilder::new_buffer(const MemoryDesc& buffer_desc) {
  return new_buffer_in(storages_.add(buffer_desc.get_size()), buffer_desc);
}

int PlanBuilder::new_buffer_in(size_t storage, const MemoryDesc& buffer_desc) {
  storages_.grow(storage, buffer_desc.get_size());
  plan_.buffers.push_back({buffer_desc, storage});
  return static_cast<int>(plan_.buffers.size()) - 1;
}

void PlanBuilder::needed_now(int buffer) {
  storages_.use(plan_.buffers[buffer].storage);
}

void PlanBuilder::push(std::unique_ptr<Task> task) {
  plan_.branches[storages_.branch()].push_back(std::move(task));
  storages_.next_task();
}

template <typename PrimitiveDesc>
void PlanBuilder::add_primitive(const PrimitiveDesc& primitive_desc, dnnl::primitive primitive,
                                std::vector<PrimitiveTask::BufferArgument> arguments,
                                std::vector<std::pair<int, dnnl::memory>> constants) {
  plan_.scratchpad_bytes =
      std::max(plan_.scratchpad_bytes, primitive_desc.scratchpad_desc().get_size());
  for (const auto& argument : arguments) needed_now(argument.buffer);
  push(std::make_unique<PrimitiveTask>(std::move(primitive), std::move(arguments),
                                       std::move(constants)));
}

void PlanBuilder::add_reorder(int from, const MemoryDesc& from_desc, int to,
                              const MemoryDesc& to_desc, const dnnl::primitive_attr& attributes) {
  const dnnl::reorder::primitive_desc reorder(engine_, from_desc, engine_, to_desc, attributes);
  add_primitive(reorder, dnnl::reorder(reorder),
                {{DNNL_ARG_FROM, from, from_desc}, {DNNL_ARG_TO, to, to_desc}});
}

int PlanBuilder::buffer_in(int id, const MemoryDesc& wanted) {
  const int original = buffer_of(id);
  if (desc(original) == wanted) return original;
  std::vector<int>& copies = copies_[{id, storages_.branch()}];
  for (const int copy : copies) {
    if (desc(copy) == wanted) return copy;
  }
  const int copy = new_buffer(wanted);
  add_reorder(original, desc(original), copy, wanted, own_scratchpad());
  copies.push_back(copy);
  return copy;
}

int PlanBuilder::plain_buffer_of(int id) {
  const int original = buffer_of(id);
  return is_plain(desc(original)) ? original : buffer_in(id, dense(id, Tag::acdb));
}

/// The value's elements, moved up by `offset` to be unsigned.
int PlanBuilder::offset_copy(int id, const MemoryDesc& wanted, int offset) {
  const int source = buffer_of(id);
  const int copy = new_buffer(wanted);
  dnnl::primitive_attr attributes = own_scratchpad();
  attributes.set_zero_points(DNNL_ARG_DST, 0, {offset});
  add_reorder(source, desc(source), copy, wanted, attributes);
  return copy;
}

/// Whether the residual's memory may take the sum: nobody reads it later, or again.
bool PlanBuilder::may_overwrite(int residual) const {
  return schedule_.last_reader[static_cast<size_t>(residual)] == position_ &&
         storages_.is_temporary(plan_.buffers[buffer_of(residual)].storage);
}

/// The sum is taken in place: the destination starts as the residual, or as a copy of it.
int PlanBuilder::destination_with_residual(const ConvStep& step, const MemoryDesc& wanted) {
  const Value& residual = value(step.residual);
  const bool same_width = size_in_bytes(residual.type) == size_in_bytes(value(step.output).type);
  const MemoryDesc as_residual = same_width ? with_type(wanted, residual.type) : wanted;
  const int source = buffer_of(step.residual);
  if (same_width && desc(source) == as_residual && may_overwrite(step.residual)) {
    return new_buffer_in(plan_.buffers[source].storage, wanted);
  }
  const int destination = new_buffer(wanted);
  add_reorder(source, desc(source), destination, as_residual,
              scaled(same_width ? 1.0F : residual.scale));
  return destination;
}

/// A convolution by our own kernels, on channel-last buffers.
void PlanBuilder::add_direct(const ConvStep& step) {
  const Value& input = value(step.input);
  const Value& output = value(step.output);
  const Value* residual = step.residual < 0 ? nullptr : &value(step.residual);
  const bool planes = desc(buffer_of(step.input)) == dense(step.input, Tag::abcd) &&
                      input.dims[1] <= DirectConvolution::kMostPlanes;
  const int source =
      planes ? buffer_of(step.input) : buffer_in(step.input, dense(step.input, Tag::acdb));
  const MemoryDesc wanted = dense(step.output, Tag::acdb);
  int added = -1;
  int destination = -1;
  if (residual != nullptr) {
    added = buffer_in(step.residual, dense(step.residual, Tag::acdb));
    const bool in_place = added == buffer_of(step.residual) && may_overwrite(step.residual) &&
                          size_in_bytes(residual->type) == size_in_bytes(output.type);
    if (in_place) destination = new_buffer_in(plan_.buffers[added].storage, wanted);
    needed_now(added);
  }
  if (destination < 0) destination = new_buffer(wanted);
  set_buffer_of(step.output, destination);
  needed_now(source);
  needed_now(destination);
  DirectConvolution convolution(step, input, output, residual, *kernels_,
                                planes ? ChannelOrder::kPlanes : ChannelOrder::kLast);
  push(std::make_unique<DirectConvolutionTask>(std::move(convolution), source, added, destination));
}

void PlanBuilder::add(const ConvStep& step) {
  if (kernels_ != nullptr && DirectConvolution::can_run(step, value(step.input), *kernels_)) {
    return add_direct(step);
  }
  const Value* residual = step.residual < 0 ? nullptr : &value(step.residual);
  const Convolution convolution =
      make_convolution(step, value(step.input), value(step.output), residual, engine_);
  const auto& pd = convolution.primitive_desc;
  const int source = convolution.input_offset == 0
                         ? buffer_in(step.input, pd.src_desc())
                         : offset_copy(step.input, pd.src_desc(), convolution.input_offset);
  const int destination = residual == nullptr ? new_buffer(pd.dst_desc())
                                              : destination_with_residual(step, pd.dst_desc());
  set_buffer_of(step.output, destination);
  add_primitive(pd, dnnl::convolution_forward(pd),
                {{DNNL_ARG_SRC, source, pd.src_desc()}, {DNNL_ARG_DST, destination, pd.dst_desc()}},
                convolution.constants);
}

void PlanBuilder::add(const MaxPoolStep& step) {
  const int source = buffer_of(step.input);
  const dnnl::pooling_forward::primitive_desc pd({dnnl::prop_kind::forward_inference,
                                                  dnnl::algorithm::pooling_max,
                                                  desc(source),
                                                  dense(step.output, Tag::any),
                                                  to_dims(step.strides),
                                                  to_dims(step.kernel),
                                                  {step.pads[0], step.pads[1]},
                                                  {step.pads[2], step.pads[3]}},
                                                 own_scratchpad(), engine_);
  set_buffer_of(step.output, new_buffer(pd.dst_desc()));
  add_primitive(pd, dnnl::pooling_forward(pd),
                {{DNNL_ARG_SRC, source, pd.src_desc()},
                 {DNNL_ARG_DST, buffer_of(step.output), pd.dst_desc()}});
}

void PlanBuilder::add(const UpsampleStep& step) {
  const int source = buffer_of(step.input);
  if (!step.linear && desc(source) == dense(step.input, Tag::acdb)) {
    const int destination = new_buffer(dense(step.output, Tag::acdb));
    set_buffer_of(step.output, destination);
    needed_now(source);
    needed_now(destination);
    return push(std::make_unique<NearestUpsampleTask>(value(step.input), source, destination));
  }
  const auto algorithm =
      step.linear ? dnnl::algorithm::resampling_linear : dnnl::algorithm::resampling_nearest;
  const dnnl::resampling_forward::primitive_desc pd(
      {dnnl::prop_kind::forward_inference, algorithm, desc(source), dense(step.output, Tag::any)},
      own_scratchpad(), engine_);
  set_buffer_of(step.output, new_buffer(pd.dst_desc()));
  add_primitive(pd, dnnl::resampling_forward(pd),
                {{DNNL_ARG_SRC, source, pd.src_desc()},
                 {DNNL_ARG_DST, buffer_of(step.output), pd.dst_desc()}});
}

void PlanBuilder::add(const AddStep& step) {
  const int left = buffer_of(step.left);
  const int right = buffer_in(step.right, with_type(desc(left), value(step.right).type));
  const float scale = value(step.output).scale;
  dnnl::primitive_attr attributes = own_scratchpad();
  attributes.set_scales(DNNL_ARG_SRC_0, 0, {value(step.left).scale / scale});
  attributes.set_scales(DNNL_ARG_SRC_1, 0, {value(step.right).scale / scale});
  if (step.relu) {
    dnnl::post_ops relu;
    relu.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
    attributes.set_post_ops(relu);
  }
  const MemoryDesc output = with_type(desc(left), value(step.output).type);
  const dnnl::binary::primitive_desc pd(
      {dnnl::algorithm::binary_add, desc(left), desc(right), output}, attributes, engine_);
  set_buffer_of(step.output, new_buffer(output));
  add_primitive(pd, dnnl::binary(pd),
                {{DNNL_ARG_SRC_0, left, desc(left)},
                 {DNNL_ARG_SRC_1, right, desc(right)},
                 {DNNL_ARG_DST, buffer_of(step.output), output}});
}

void PlanBuilder::add(const ReluStep& step) {
  const int source = buffer_of(step.input);
  const MemoryDesc layout = desc(source);
  const dnnl::eltwise_forward::primitive_desc pd(
      {dnnl::prop_kind::forward_inference, dnnl::algorithm::eltwise_relu, layout, 0.0F, 0.0F},
      own_scratchpad(), engine_);
  set_buffer_of(step.output, new_buffer(layout));
  add_primitive(pd, dnnl::eltwise_forward(pd),
                {{DNNL_ARG_SRC, source, layout}, {DNNL_ARG_DST, buffer_of(step.output), layout}});
}

void PlanBuilder::add(const ConvertStep& step) {
  const int source = buffer_of(step.input);
  const MemoryDesc from = desc(source);
  const MemoryDesc to = with_type(from, value(step.output).type);
  set_buffer_of(step.output, new_buffer(to));
  add_reorder(source, from, buffer_of(step.output), to,
              scaled(value(step.input).scale / value(step.output).scale));
}

void PlanBuilder::add(const RearrangeStep& step) {
  const int source = plain_buffer_of(step.input);
  const int destination = new_buffer(dense(step.output, Tag::acdb));
  set_buffer_of(step.output, destination);
  const std::vector<int32_t> from = places(desc(source));
  const std::vector<int32_t> to = places(desc(destination));
  std::vector<int32_t> in_memory_order(to.size());
  for (size_t i = 0; i < to.size(); ++i) in_memory_order[to[i]] = from[step.source[i]];
  needed_now(source);
  needed_now(destination);
  push(std::make_unique<RearrangeTask>(source, destination, size_in_bytes(value(step.output).type),
                                       std::move(in_memory_order)));
}

void PlanBuilder::add(const ConcatStep& step) {
  std::vector<MemoryDesc> sources;
  std::vector<PrimitiveTask::BufferArgument> arguments;
  for (const int input : step.inputs) {
    const int argument = DNNL_ARG_MULTIPLE_SRC + static_cast<int>(sources.size());
    sources.push_back(desc(buffer_of(input)));
    arguments.push_back({argument, buffer_of(input), sources.back()});
  }
  const dnnl::concat::primitive_desc pd(dense(step.output, Tag::any), 1, sources, engine_,
                                        own_scratchpad());
  set_buffer_of(step.output, new_buffer(pd.dst_desc()));
  arguments.push_back({DNNL_ARG_DST, buffer_of(step.output), pd.dst_desc()});
  add_primitive(pd, dnnl::concat(pd), std::move(arguments));
}

void PlanBuilder::add(const ViewStep& step) {
  const Value& from = value(step.input);
  const Value& to = value(step.output);
  const int source = buffer_in(step.input, dense(step.input, Tag::acdb));
  const int destination = new_buffer(dense(step.output, Tag::acdb));
  set_buffer_of(step.output, destination);
  needed_now(source);
  needed_now(destination);
  push(std::make_unique<ViewTask>(source, from.type, destination, to.type,
                                  static_cast<int>(to.dims[1]), from.scale / to.scale, entries_));
}

/// Outputs are dense floats that stay until their branch runs again.
void PlanBuilder::add_output(size_t output) {
  const int id = program_.outputs[output].value;
  const int source = buffer_of(id);
  const MemoryDesc wanted = with_type(dense(id, Tag::abcd), ElementType::kFloat32);
  const int destination = new_buffer(wanted);
  if (value(id).type == ElementType::kFloat32 && desc(source) == dense(id, Tag::acdb)) {
    needed_now(source);
    needed_now(destination);
    push(std::make_unique<ExportTask>(value(id), source, destination));
  } else {
    add_reorder(source, desc(source), destination, wanted, scaled(value(id).scale));
  }
  storages_.keep(plan_.buffers[destination].storage);
  plan_.output_buffers[output] = destination;
}

}  // namespace

ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const dnnl::engine& engine, const ViewEntries& entries,
                         const KernelSet* kernels) {
  return PlanBuilder(program, branches, engine, entries, kernels).build();
}

}  // namespace bevloc::nn::onednn
