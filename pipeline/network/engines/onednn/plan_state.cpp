#include "pipeline/network/engines/onednn/plan_state.h"

#include <algorithm>

#include "pipeline/network/engines/onednn/convolution.h"

namespace bevloc::nn::onednn {
namespace {

bool is_plain(const MemoryDesc& desc) {
  return desc.data.format_kind == dnnl_blocked && desc.data.format_desc.blocking.inner_nblks == 0;
}

}  // namespace

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

PlanState::PlanState(const Program& program, size_t branches, const dnnl::engine& engine)
    : program_(program), engine_(engine), buffer_of_value_(program.values.size(), -1) {
  plan_.branches.resize(branches);
  plan_.output_buffers.resize(program.outputs.size());
}

MemoryDesc PlanState::dense(int id, dnnl::memory::format_tag tag) const {
  return {to_dims(value(id).dims), onednn_type(value(id).type), tag};
}

int PlanState::new_buffer(const MemoryDesc& buffer_desc) {
  plan_.buffers.push_back({buffer_desc, storages_.add(buffer_desc.get_size())});
  return static_cast<int>(plan_.buffers.size()) - 1;
}

int PlanState::new_buffer_over(int buffer, const MemoryDesc& buffer_desc) {
  const size_t shared = storage(buffer);
  storages_.grow(shared, buffer_desc.get_size());
  plan_.buffers.push_back({buffer_desc, shared});
  return static_cast<int>(plan_.buffers.size()) - 1;
}

int PlanState::buffer_in(int id, const MemoryDesc& wanted) {
  const int original = buffer_of(id);
  if (desc(original) == wanted) return original;
  std::vector<int>& copies = copies_[{id, storages_.branch()}];
  for (const int copy : copies) {
    if (desc(copy) == wanted) return copy;
  }
  const int copy = new_buffer(wanted);
  push_reorder(original, desc(original), copy, wanted, own_scratchpad());
  copies.push_back(copy);
  return copy;
}

int PlanState::plain_buffer_of(int id) {
  const int original = buffer_of(id);
  if (is_plain(desc(original))) return original;
  return buffer_in(id, dense(id, dnnl::memory::format_tag::acdb));
}

int PlanState::offset_copy(int id, const MemoryDesc& wanted, int offset) {
  const int source = buffer_of(id);
  const int copy = new_buffer(wanted);
  dnnl::primitive_attr attributes = own_scratchpad();
  attributes.set_zero_points(DNNL_ARG_DST, 0, {offset});
  push_reorder(source, desc(source), copy, wanted, attributes);
  return copy;
}

void PlanState::push(std::unique_ptr<Task> task, std::initializer_list<int> used) {
  for (const int buffer : used) storages_.use(storage(buffer));
  plan_.branches[storages_.branch()].push_back(std::move(task));
  storages_.next_task();
}

void PlanState::push_primitive(const dnnl::primitive_desc_base& primitive_desc,
                               dnnl::primitive primitive,
                               std::vector<PrimitiveTask::BufferArgument> arguments,
                               std::vector<std::pair<int, dnnl::memory>> constants) {
  plan_.scratchpad_bytes =
      std::max(plan_.scratchpad_bytes, primitive_desc.scratchpad_desc().get_size());
  for (const auto& argument : arguments) storages_.use(storage(argument.buffer));
  push(std::make_unique<PrimitiveTask>(std::move(primitive), std::move(arguments),
                                       std::move(constants)),
       {});
}

void PlanState::push_reorder(int from, const MemoryDesc& from_desc, int to,
                             const MemoryDesc& to_desc, const dnnl::primitive_attr& attributes) {
  const dnnl::reorder::primitive_desc reorder(engine_, from_desc, engine_, to_desc, attributes);
  push_primitive(reorder, dnnl::reorder(reorder),
                 {{DNNL_ARG_FROM, from, from_desc}, {DNNL_ARG_TO, to, to_desc}});
}

}  // namespace bevloc::nn::onednn
