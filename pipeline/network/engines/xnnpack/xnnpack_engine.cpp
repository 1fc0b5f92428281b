#include "pipeline/network/engines/xnnpack/xnnpack_engine.h"

#include <xnnpack.h>

#include "pipeline/network/engines/xnnpack/plan_builder.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace xnnpack {
namespace {

struct DestroyThreads {
  void operator()(pthreadpool_t threads) const { pthreadpool_destroy(threads); }
};
using Threads = std::unique_ptr<pthreadpool, DestroyThreads>;

/// A pool of `count` threads. Null for one thread, because that is the caller's.
Threads make_threads(int count) {
  if (count == 1) return nullptr;
  Threads threads(pthreadpool_create(static_cast<size_t>(count)));
  if (threads == nullptr) refuse("cannot start {} threads", count);
  return threads;
}

class XnnpackEngine : public Engine {
 public:
  XnnpackEngine(const Program& program, std::span<const Branch> branches, int view_cells,
                int threads);

  void run(size_t branch) override;
  void parallel_for(int count, LoopBody body) override;

 private:
  Threads threads_;
  std::vector<std::vector<std::unique_ptr<Task>>> branches_;
};

XnnpackEngine::XnnpackEngine(const Program& program, std::span<const Branch> branches,
                             int view_cells, int threads)
    : Engine(view_cells), threads_(make_threads(threads)) {
  ExecutionPlan plan = build_plan(program, branches, view_entries());
  const std::vector<std::byte*> storages = allocate(plan.storages);
  const auto memory = [&](size_t storage) -> std::span<std::byte> {
    return {storages[storage], plan.storages[storage].bytes};
  };
  for (size_t i = 0; i < program.inputs.size(); ++i) {
    add_input(program.inputs[i].name, memory(plan.input_storages[i]));
  }
  for (size_t i = 0; i < program.outputs.size(); ++i) {
    add_output(program.outputs[i].name, memory(plan.output_storages[i]));
  }
  for (auto& branch : plan.branches) {
    for (auto& task : branch) task->bind(storages, threads_.get());
  }
  branches_ = std::move(plan.branches);
}

void XnnpackEngine::run(size_t branch) {
  for (const auto& task : branches_[branch]) task->run(threads_.get());
}

void XnnpackEngine::parallel_for(int count, LoopBody body) {
  const auto call = [](void* context, size_t index) {
    (*static_cast<const LoopBody*>(context))(static_cast<int>(index));
  };
  pthreadpool_parallelize_1d(threads_.get(), call, &body, static_cast<size_t>(count), 0);
}

}  // namespace
}  // namespace xnnpack

std::unique_ptr<Engine> make_xnnpack_engine(const Program& program,
                                            std::span<const Branch> branches, int view_cells,
                                            const EngineOptions& options) {
  if (options.isa != IsaCap::kBest) {
    refuse("XNNPACK selects its instructions itself: found a cap, wanted none");
  }
  if (xnn_initialize(nullptr) != xnn_status_success) refuse("XNNPACK does not support this CPU");
  return std::make_unique<xnnpack::XnnpackEngine>(program, branches, view_cells, options.threads);
}

}  // namespace bevloc::nn
