#include "pipeline/network/engine/engine.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

#include <dnnl.hpp>
#include <omp.h>

#include "pipeline/network/engine/isa.h"
#include "pipeline/network/engine/parallel_for.h"
#include "pipeline/network/engine/plan_builder.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

/// Vectorised kernels may read, but not write, past the end of a buffer.
constexpr size_t kReadMarginBytes = 64;

dnnl::engine make_cpu_engine(int threads) {
  // oneDNN compiles kernels for the number of threads that is set at this time.
  omp_set_num_threads(threads);
  return {dnnl::engine::kind::cpu, 0};
}

}  // namespace

struct Engine::Execution {
  explicit Execution(int threads) : engine(make_cpu_engine(threads)), stream(engine) {}

  dnnl::engine engine;
  dnnl::stream stream;
  std::vector<std::vector<std::unique_ptr<onednn::Task>>> branches;
};

Engine::Engine(const Program& program, std::span<const Branch> branches, int view_cells,
               const EngineOptions& options)
    : threads_(options.threads), view_entries_(view_cells) {
  onednn::cap_cpu_isa(options.isa);
  try {
    execution_ = std::make_unique<Execution>(options.threads);
    const KernelSet* const kernels = options.own_kernels ? &kernel_set(options.isa) : nullptr;
    auto plan = onednn::build_plan(program, branches, execution_->engine, view_entries_, kernels);
    bind(program, plan);
    execution_->branches = std::move(plan.branches);
  } catch (const dnnl::error& error) {
    refuse("oneDNN cannot run the model: {}", error.what());
  }
}

Engine::~Engine() = default;

void Engine::AlignedFree::operator()(std::byte* memory) const {
  ::operator delete[](memory, std::align_val_t{kBufferAlignment});
}

std::vector<std::byte*> Engine::allocate(std::span<const Lifetime> storages) {
  const MemoryPlan plan = plan_memory(storages);
  arena_bytes_ = plan.total_bytes;
  for (const Lifetime& storage : storages) bytes_without_reuse_ += storage.bytes;
  const size_t bytes = arena_bytes_ + kReadMarginBytes;
  arena_.reset(
      static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{kBufferAlignment})));
  std::memset(arena_.get(), 0, bytes);
  std::vector<std::byte*> addresses;
  for (const size_t offset : plan.offsets) addresses.push_back(arena_.get() + offset);
  return addresses;
}

void Engine::bind(const Program& program, onednn::ExecutionPlan& plan) {
  const std::vector<std::byte*> storages = allocate(plan.storages);
  std::vector<onednn::PlacedBuffer> placed;
  for (const onednn::ExecutionPlan::Buffer& buffer : plan.buffers) {
    placed.push_back({buffer.desc, storages[buffer.storage]});
  }
  const auto port = [&placed](const std::string& name, int buffer) -> Port {
    const onednn::PlacedBuffer& found = placed[static_cast<size_t>(buffer)];
    return {name, {found.data, found.desc.get_size()}};
  };
  for (size_t i = 0; i < program.inputs.size(); ++i) {
    inputs_.push_back(port(program.inputs[i].name, plan.input_buffers[i]));
  }
  for (size_t i = 0; i < program.outputs.size(); ++i) {
    outputs_.push_back(port(program.outputs[i].name, plan.output_buffers[i]));
  }
  const dnnl::memory::dim scratchpad_bytes =
      static_cast<dnnl::memory::dim>(std::max<size_t>(1, plan.scratchpad_bytes));
  const dnnl::memory scratchpad(
      {{scratchpad_bytes}, dnnl::memory::data_type::u8, dnnl::memory::format_tag::a},
      execution_->engine);
  for (auto& branch : plan.branches) {
    for (auto& task : branch) task->bind(placed, scratchpad);
  }
}

std::span<std::byte> Engine::input(const std::string& name) {
  const auto port = std::ranges::find(inputs_, name, &Port::name);
  assert(port != inputs_.end());
  return port->memory;
}

std::span<const float> Engine::output(const std::string& name) const {
  const auto port = std::ranges::find(outputs_, name, &Port::name);
  assert(port != outputs_.end());
  const std::span<std::byte> memory = port->memory;
  return {reinterpret_cast<const float*>(memory.data()), memory.size() / sizeof(float)};
}

void Engine::run(size_t branch) {
  // OpenMP stores this number per calling thread, and any thread may call run().
  omp_set_num_threads(threads_);
  for (const auto& task : execution_->branches[branch]) task->run(execution_->stream.get());
}

void Engine::parallel_for(int count, LoopBody body) {
  omp_set_num_threads(threads_);
  onednn::parallel_for(count, body);
}

}  // namespace bevloc::nn
