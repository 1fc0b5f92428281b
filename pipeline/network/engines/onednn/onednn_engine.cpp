#include "pipeline/network/engines/onednn/onednn_engine.h"

#include <algorithm>

#include <dnnl.hpp>
#include <omp.h>

#include "pipeline/network/engines/onednn/isa.h"
#include "pipeline/network/engines/onednn/parallel.h"
#include "pipeline/network/engines/onednn/plan_builder.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace onednn {
namespace {

dnnl::engine make_cpu_engine(int threads) {
  // oneDNN compiles kernels for the number of threads that is set at this time.
  omp_set_num_threads(threads);
  return {dnnl::engine::kind::cpu, 0};
}

class OneDnnEngine : public Engine {
 public:
  OneDnnEngine(const Program& program, std::span<const Branch> branches, int view_cells,
               const EngineOptions& options);

  void run(size_t branch) override;
  void parallel_for(int count, LoopBody body) override;

 private:
  void bind(const Program& program, ExecutionPlan& plan);

  int threads_;
  dnnl::engine engine_;
  dnnl::stream stream_;
  std::vector<std::vector<std::unique_ptr<Task>>> branches_;
};

OneDnnEngine::OneDnnEngine(const Program& program, std::span<const Branch> branches, int view_cells,
                           const EngineOptions& options)
    : Engine(view_cells),
      threads_(options.threads),
      engine_(make_cpu_engine(options.threads)),
      stream_(engine_) {
  const KernelSet* const kernels = options.own_kernels ? &kernel_set(options.isa) : nullptr;
  ExecutionPlan plan = build_plan(program, branches, engine_, view_entries(), kernels);
  bind(program, plan);
  branches_ = std::move(plan.branches);
}

void OneDnnEngine::bind(const Program& program, ExecutionPlan& plan) {
  const std::vector<std::byte*> storages = allocate(plan.storages);
  std::vector<PlacedBuffer> placed;
  for (const ExecutionPlan::Buffer& buffer : plan.buffers) {
    placed.push_back({buffer.desc, storages[buffer.storage]});
  }
  const auto memory = [&placed](int buffer) -> std::span<std::byte> {
    const PlacedBuffer& found = placed[static_cast<size_t>(buffer)];
    return {found.data, found.desc.get_size()};
  };
  for (size_t i = 0; i < program.inputs.size(); ++i) {
    add_input(program.inputs[i].name, memory(plan.input_buffers[i]));
  }
  for (size_t i = 0; i < program.outputs.size(); ++i) {
    add_output(program.outputs[i].name, memory(plan.output_buffers[i]));
  }
  const dnnl::memory::dim scratchpad_bytes =
      static_cast<dnnl::memory::dim>(std::max<size_t>(1, plan.scratchpad_bytes));
  const dnnl::memory scratchpad(
      {{scratchpad_bytes}, dnnl::memory::data_type::u8, dnnl::memory::format_tag::a}, engine_);
  for (auto& branch : plan.branches) {
    for (auto& task : branch) task->bind(placed, scratchpad);
  }
}

void OneDnnEngine::run(size_t branch) {
  // OpenMP stores this number per calling thread, and any thread may call run().
  omp_set_num_threads(threads_);
  for (const auto& task : branches_[branch]) task->run(stream_.get());
}

void OneDnnEngine::parallel_for(int count, LoopBody body) {
  omp_set_num_threads(threads_);
  onednn::parallel_for(count, body);
}

}  // namespace
}  // namespace onednn

std::unique_ptr<Engine> make_onednn_engine(const Program& program, std::span<const Branch> branches,
                                           int view_cells, const EngineOptions& options) {
  onednn::cap_cpu_isa(options.isa);
  try {
    return std::make_unique<onednn::OneDnnEngine>(program, branches, view_cells, options);
  } catch (const dnnl::error& error) {
    refuse("oneDNN cannot run the model: {}", error.what());
  }
}

}  // namespace bevloc::nn
