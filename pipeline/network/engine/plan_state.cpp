#include "pipeline/network/engine/plan_state.h"

#include <algorithm>

namespace bevloc::nn::onednn {

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
  push_copy(original, desc(original), copy, wanted);
  copies.push_back(copy);
  return copy;
}

int PlanState::offset_copy(int id, const MemoryDesc& wanted, int offset) {
  const int source = buffer_of(id);
  const int copy = new_buffer(wanted);
  push_copy(source, desc(source), copy, wanted, {.offset = offset});
  return copy;
}

void PlanState::push(std::unique_ptr<Task> task, std::initializer_list<int> used) {
  for (const int buffer : used) storages_.use(storage(buffer));
  plan_.branches[storages_.branch()].push_back(std::move(task));
  storages_.next_task();
}

void PlanState::push_primitive(Primitive primitive,
                               std::vector<PrimitiveTask::BufferArgument> arguments) {
  plan_.scratchpad_bytes = std::max(plan_.scratchpad_bytes, primitive.scratchpad_bytes);
  for (const auto& argument : arguments) storages_.use(storage(argument.buffer));
  push(std::make_unique<PrimitiveTask>(std::move(primitive.primitive), std::move(arguments),
                                       std::move(primitive.constants)),
       {});
}

void PlanState::push_copy(int from, const MemoryDesc& from_desc, int to, const MemoryDesc& to_desc,
                          Conversion conversion) {
  push_primitive(make_copy(from_desc, to_desc, conversion, engine_),
                 {{DNNL_ARG_FROM, from, from_desc}, {DNNL_ARG_TO, to, to_desc}});
}

}  // namespace bevloc::nn::onednn
