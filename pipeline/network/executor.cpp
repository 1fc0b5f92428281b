#include "pipeline/network/executor.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

#include <omp.h>

namespace bevloc::nn {
namespace {

dnnl::engine make_engine(int threads) {
  // Kernels are made for the number of threads that is set at the time.
  omp_set_num_threads(threads);
  return {dnnl::engine::kind::cpu, 0};
}

}  // namespace

void Executor::AlignedFree::operator()(std::byte* memory) const {
  ::operator delete[](memory, std::align_val_t{kBufferAlignment});
}

Executor::Executor(const Program& program, std::span<const Branch> branches, int view_cells,
                   int threads)
    : threads_(threads),
      engine_(make_engine(threads)),
      stream_(engine_),
      view_entries_(view_cells) {
  ExecutionPlan plan = build_plan(program, branches, engine_, view_entries_);
  for (const ProgramPort& input : program.inputs) inputs_.push_back({input.name});
  for (const ProgramPort& output : program.outputs) outputs_.push_back({output.name});
  place_buffers(plan);
  branches_ = std::move(plan.branches);
}

void Executor::place_buffers(ExecutionPlan& plan) {
  const MemoryPlan memory = plan_memory(plan.storages);
  arena_bytes_ = memory.total_bytes;
  for (const Lifetime& storage : plan.storages) bytes_without_reuse_ += storage.bytes;
  const size_t bytes = std::max<size_t>(1, arena_bytes_);
  arena_.reset(
      static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{kBufferAlignment})));
  std::memset(arena_.get(), 0, bytes);

  std::vector<PlacedBuffer> placed;
  for (const ExecutionPlan::Buffer& buffer : plan.buffers) {
    placed.push_back({buffer.desc, arena_.get() + memory.offsets[buffer.storage]});
  }
  const auto bind_port = [&placed](Port& port, int buffer) {
    const PlacedBuffer& place = placed[static_cast<size_t>(buffer)];
    port.data = place.data;
    port.bytes = place.desc.get_size();
  };
  for (size_t i = 0; i < inputs_.size(); ++i) bind_port(inputs_[i], plan.input_buffers[i]);
  for (size_t i = 0; i < outputs_.size(); ++i) bind_port(outputs_[i], plan.output_buffers[i]);

  const dnnl::memory::dim scratchpad_bytes =
      static_cast<dnnl::memory::dim>(std::max<size_t>(1, plan.scratchpad_bytes));
  const dnnl::memory scratchpad(
      {{scratchpad_bytes}, dnnl::memory::data_type::u8, dnnl::memory::format_tag::a}, engine_);
  for (auto& branch : plan.branches) {
    for (auto& task : branch) task->bind(placed, scratchpad);
  }
}

std::span<std::byte> Executor::input(const std::string& name) {
  const auto port = std::ranges::find(inputs_, name, &Port::name);
  assert(port != inputs_.end());
  return {port->data, port->bytes};
}

std::span<const float> Executor::output(const std::string& name) const {
  const auto port = std::ranges::find(outputs_, name, &Port::name);
  assert(port != outputs_.end());
  return {reinterpret_cast<const float*>(port->data), port->bytes / sizeof(float)};
}

void Executor::run(size_t branch) {
  // OpenMP keeps this number for each calling thread.
  omp_set_num_threads(threads_);
  for (const auto& task : branches_[branch]) task->run(stream_.get());
}

}  // namespace bevloc::nn
