#include "pipeline/network/engine/plan_builder.h"

#include <algorithm>

#include "pipeline/network/engine/direct_task.h"
#include "pipeline/network/engine/isa.h"
#include "pipeline/network/engine/plan_state.h"
#include "pipeline/network/model/load_error.h"
#include "pipeline/network/plan/schedule.h"

namespace bevloc::nn::onednn {
namespace {

using Tag = dnnl::memory::format_tag;

/// For each element in row-major order, its offset in memory.
std::vector<int32_t> memory_offsets(const MemoryDesc& desc) {
  const dnnl::memory::dims dims = dims_of(desc);
  const dnnl::memory::dims strides = strides_of(desc);
  std::vector<int32_t> offsets;
  for (int64_t n = 0; n < dims[0]; ++n) {
    for (int64_t c = 0; c < dims[1]; ++c) {
      for (int64_t h = 0; h < dims[2]; ++h) {
        for (int64_t w = 0; w < dims[3]; ++w) {
          offsets.push_back(static_cast<int32_t>(n * strides[0] + c * strides[1] + h * strides[2] +
                                                 w * strides[3]));
        }
      }
    }
  }
  return offsets;
}

/// Adds the tasks of each step to the plan.
class PlanBuilder {
 public:
  PlanBuilder(const Program& program, std::span<const Branch> branches, const dnnl::engine& engine,
              const ViewEntries& entries, const KernelSet* kernels)
      : entries_(entries),
        kernels_(kernels),
        schedule_(make_schedule(program, branches)),
        state_(program, branches.size(), engine) {}
  ExecutionPlan build();

 private:
  void add(const ConvStep& step);
  void add(const MaxPoolStep& step);
  void add(const UpsampleStep& step);
  void add(const AddStep& step);
  void add(const ReluStep& step);
  void add(const ConvertStep& step);
  void add(const RearrangeStep& step);
  void add(const ConcatStep& step);
  void add(const ViewStep& step);
  void add_direct(const ConvStep& step);
  template <typename Make>
  void add_channels_last(int input, int output, const Make& make);
  void add_output(size_t output);

  const Value& value(int id) const { return state_.value(id); }
  const Value* residual_of(const ConvStep& step) const {
    return step.residual < 0 ? nullptr : &value(step.residual);
  }
  int destination_with_residual(const ConvStep& step, const MemoryDesc& wanted);
  bool may_overwrite(int residual);

  const ViewEntries& entries_;
  const KernelSet* kernels_;  ///< our own kernels for convolutions; may be null
  const Schedule schedule_;
  PlanState state_;
  size_t position_ = 0;  ///< position of the current step in the order of the schedule
};

ExecutionPlan PlanBuilder::build() {
  ExecutionPlan& plan = state_.plan();
  const Program& program = state_.program();
  for (const ProgramPort& input : program.inputs) {
    const int buffer = state_.new_buffer(state_.dense(input.value, Tag::abcd));
    state_.storages().keep(state_.storage(buffer));
    plan.input_buffers.push_back(state_.set_buffer_of(input.value, buffer));
  }
  walk(
      program, schedule_, plan.branches.size(), state_.storages(),
      [this](const Step& step, size_t position) {
        position_ = position;
        std::visit([this](const auto& known) { add(known); }, step);
      },
      [this](size_t output) { add_output(output); });
  plan.storages = state_.storages().lifetimes();
  return std::move(plan);
}

/// Whether the output may overwrite the residual: no other step reads the residual later.
bool PlanBuilder::may_overwrite(int residual) {
  return schedule_.last_reader[static_cast<size_t>(residual)] == position_ &&
         state_.storages().is_temporary(state_.storage(state_.buffer_of(residual)));
}

/// oneDNN adds the convolution to its destination, so the destination must contain the residual:
/// it is the residual's own buffer or a copy of it.
int PlanBuilder::destination_with_residual(const ConvStep& step, const MemoryDesc& wanted) {
  const Value& residual = value(step.residual);
  const bool same_width = size_in_bytes(residual.type) == size_in_bytes(value(step.output).type);
  const MemoryDesc as_residual = same_width ? with_type(wanted, residual.type) : wanted;
  const int source = state_.buffer_of(step.residual);
  if (same_width && state_.desc(source) == as_residual && may_overwrite(step.residual)) {
    return state_.new_buffer_over(source, wanted);
  }
  const int destination = state_.new_buffer(wanted);
  state_.push_copy(source, state_.desc(source), destination, as_residual,
                   {.scale = same_width ? 1.0F : residual.scale});
  return destination;
}

/// Adds a convolution by our own kernels, on channel-last buffers.
void PlanBuilder::add_direct(const ConvStep& step) {
  const Value& input = value(step.input);
  const Value& output = value(step.output);
  const Value* residual = residual_of(step);
  const int original = state_.buffer_of(step.input);
  const bool planes = state_.desc(original) == state_.dense(step.input, Tag::abcd) &&
                      input.dims[1] <= DirectConvolution::kMostPlanes;
  const int source =
      planes ? original : state_.buffer_in(step.input, state_.dense(step.input, Tag::acdb));
  const MemoryDesc wanted = state_.dense(step.output, Tag::acdb);
  int added = -1;
  int destination = -1;
  if (residual != nullptr) {
    added = state_.buffer_in(step.residual, state_.dense(step.residual, Tag::acdb));
    const bool in_place = added == state_.buffer_of(step.residual) &&
                          may_overwrite(step.residual) &&
                          size_in_bytes(residual->type) == size_in_bytes(output.type);
    if (in_place) destination = state_.new_buffer_over(added, wanted);
  }
  if (destination < 0) destination = state_.new_buffer(wanted);
  state_.set_buffer_of(step.output, destination);
  DirectConvolution convolution(step, input, output, residual, *kernels_,
                                planes ? ChannelOrder::kPlanes : ChannelOrder::kLast);
  state_.push(
      std::make_unique<DirectConvolutionTask>(std::move(convolution), source, added, destination),
      {source, destination, added < 0 ? source : added});
}

/// Without VNNI, oneDNN adds the products of two 8-bit numbers in 16 bits, and larger sums
/// saturate. With weights of up to kMostInexact no sum saturates.
void check_products(const ConvStep& step) {
  constexpr int kMostInexact = 64;
  if (step.weights.type != ElementType::kInt8 || has_exact_int8_products()) return;
  const auto [least, most] = std::ranges::minmax(int8_weights(step));
  if (least >= -kMostInexact && most <= kMostInexact) return;
  refuse(
      "found 8-bit weights from {} to {}, wanted at most {} on this processor, which has no "
      "VNNI: quantize the model with 7-bit weights (docs/quantization.md)",
      least, most, kMostInexact);
}

void PlanBuilder::add(const ConvStep& step) {
  if (kernels_ != nullptr && DirectConvolution::can_run(step, value(step.input), *kernels_)) {
    return add_direct(step);
  }
  check_products(step);
  const Value* residual = residual_of(step);
  Convolution convolution =
      make_convolution(step, value(step.input), value(step.output), residual, state_.engine());
  const int source =
      convolution.input_offset == 0
          ? state_.buffer_in(step.input, convolution.source)
          : state_.offset_copy(step.input, convolution.source, convolution.input_offset);
  const int destination = residual == nullptr
                              ? state_.new_buffer(convolution.destination)
                              : destination_with_residual(step, convolution.destination);
  state_.set_buffer_of(step.output, destination);
  state_.push_primitive(std::move(convolution.primitive),
                        {{DNNL_ARG_SRC, source, convolution.source},
                         {DNNL_ARG_DST, destination, convolution.destination}});
}

/// Adds a primitive from one channel-last buffer to another.
template <typename Make>
void PlanBuilder::add_channels_last(int input, int output, const Make& make) {
  const MemoryDesc from = state_.dense(input, Tag::acdb);
  const MemoryDesc to = state_.dense(output, Tag::acdb);
  const int source = state_.buffer_in(input, from);
  const int destination = state_.set_buffer_of(output, state_.new_buffer(to));
  state_.push_primitive(make(from, to),
                        {{DNNL_ARG_SRC, source, from}, {DNNL_ARG_DST, destination, to}});
}

void PlanBuilder::add(const MaxPoolStep& step) {
  add_channels_last(step.input, step.output, [&](const MemoryDesc& from, const MemoryDesc& to) {
    return make_max_pool(step, from, to, state_.engine());
  });
}

void PlanBuilder::add(const UpsampleStep& step) {
  if (step.linear) {
    return add_channels_last(step.input, step.output,
                             [&](const MemoryDesc& from, const MemoryDesc& to) {
                               return make_upsample(step, from, to, state_.engine());
                             });
  }
  const int source = state_.buffer_in(step.input, state_.dense(step.input, Tag::acdb));
  const int destination =
      state_.set_buffer_of(step.output, state_.new_buffer(state_.dense(step.output, Tag::acdb)));
  state_.push(std::make_unique<NearestUpsampleTask>(value(step.input), source, destination),
              {source, destination});
}

void PlanBuilder::add(const AddStep& step) {
  const int left = state_.buffer_of(step.left);
  const int right =
      state_.buffer_in(step.right, with_type(state_.desc(left), value(step.right).type));
  const float scale = value(step.output).scale;
  const MemoryDesc layout = with_type(state_.desc(left), value(step.output).type);
  const int destination = state_.set_buffer_of(step.output, state_.new_buffer(layout));
  state_.push_primitive(make_sum(state_.desc(left), state_.desc(right), layout,
                                 {value(step.left).scale / scale, value(step.right).scale / scale},
                                 step.relu, state_.engine()),
                        {{DNNL_ARG_SRC_0, left, state_.desc(left)},
                         {DNNL_ARG_SRC_1, right, state_.desc(right)},
                         {DNNL_ARG_DST, destination, layout}});
}

void PlanBuilder::add(const ReluStep& step) {
  const int source = state_.buffer_of(step.input);
  const MemoryDesc layout = state_.desc(source);
  const int destination = state_.set_buffer_of(step.output, state_.new_buffer(layout));
  state_.push_primitive(make_relu(layout, state_.engine()),
                        {{DNNL_ARG_SRC, source, layout}, {DNNL_ARG_DST, destination, layout}});
}

void PlanBuilder::add(const ConvertStep& step) {
  const int source = state_.buffer_of(step.input);
  const MemoryDesc from = state_.desc(source);
  const MemoryDesc to = with_type(from, value(step.output).type);
  const int destination = state_.set_buffer_of(step.output, state_.new_buffer(to));
  state_.push_copy(source, from, destination, to,
                   {.scale = value(step.input).scale / value(step.output).scale});
}

void PlanBuilder::add(const RearrangeStep& step) {
  const int source = state_.buffer_of(step.input);
  const int destination =
      state_.set_buffer_of(step.output, state_.new_buffer(state_.dense(step.output, Tag::acdb)));
  const std::vector<int32_t> from = memory_offsets(state_.desc(source));
  const std::vector<int32_t> to = memory_offsets(state_.desc(destination));
  std::vector<int32_t> in_memory_order(to.size());
  for (size_t i = 0; i < to.size(); ++i) in_memory_order[to[i]] = from[step.source[i]];
  const size_t element_bytes = size_in_bytes(value(step.output).type);
  state_.push(std::make_unique<RearrangeTask>(source, destination, element_bytes,
                                              std::move(in_memory_order)),
              {source, destination});
}

void PlanBuilder::add(const ConcatStep& step) {
  std::vector<MemoryDesc> sources;
  std::vector<PrimitiveTask::BufferArgument> arguments;
  for (const int input : step.inputs) {
    const int argument = DNNL_ARG_MULTIPLE_SRC + static_cast<int>(sources.size());
    sources.push_back(state_.desc(state_.buffer_of(input)));
    arguments.push_back({argument, state_.buffer_of(input), sources.back()});
  }
  const MemoryDesc joined = state_.dense(step.output, Tag::acdb);
  const int destination = state_.set_buffer_of(step.output, state_.new_buffer(joined));
  arguments.push_back({DNNL_ARG_DST, destination, joined});
  state_.push_primitive(make_concat(sources, joined, state_.engine()), std::move(arguments));
}

void PlanBuilder::add(const ViewStep& step) {
  const Value& from = value(step.input);
  const Value& to = value(step.output);
  const int source = state_.buffer_in(step.input, state_.dense(step.input, Tag::acdb));
  const int destination =
      state_.set_buffer_of(step.output, state_.new_buffer(state_.dense(step.output, Tag::acdb)));
  state_.push(
      std::make_unique<ViewTask>(source, from.type, destination, to.type,
                                 static_cast<int>(to.dims[1]), from.scale / to.scale, entries_),
      {source, destination});
}

/// Copies an output to dense floats, which stay until its branch runs again.
void PlanBuilder::add_output(size_t output) {
  const int id = state_.program().outputs[output].value;
  const int source = state_.buffer_of(id);
  const MemoryDesc wanted = with_type(state_.dense(id, Tag::abcd), ElementType::kFloat32);
  const int destination = state_.new_buffer(wanted);
  if (value(id).type == ElementType::kFloat32 &&
      state_.desc(source) == state_.dense(id, Tag::acdb)) {
    state_.push(std::make_unique<ExportTask>(value(id), source, destination),
                {source, destination});
  } else {
    state_.push_copy(source, state_.desc(source), destination, wanted, {.scale = value(id).scale});
  }
  state_.storages().keep(state_.storage(destination));
  state_.plan().output_buffers[output] = destination;
}

}  // namespace

ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const dnnl::engine& engine, const ViewEntries& entries,
                         const KernelSet* kernels) {
  return PlanBuilder(program, branches, engine, entries, kernels).build();
}

}  // namespace bevloc::nn::onednn
