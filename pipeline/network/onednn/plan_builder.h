// From a program to tasks on buffers: chooses memory layouts and oneDNN primitives, and finds out
// from when to when each buffer is needed.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pipeline/network/engine.h"
#include "pipeline/network/kernels/strip_kernels.h"
#include "pipeline/network/memory_plan.h"
#include "pipeline/network/onednn/task.h"
#include "pipeline/network/program.h"

namespace bevloc::nn::onednn {

struct ExecutionPlan {
  struct Buffer {
    MemoryDesc desc;
    size_t storage = 0;
  };

  std::vector<Buffer> buffers;
  std::vector<Lifetime> storages;
  std::vector<std::vector<std::unique_ptr<Task>>> branches;
  std::vector<int> input_buffers;   ///< as the program's inputs: dense, as the model says
  std::vector<int> output_buffers;  ///< as the program's outputs: dense floats
  size_t scratchpad_bytes = 0;
};

/// Every output must be in exactly one branch. `entries` must outlive the plan. `kernels` are for
/// the int8 convolutions that they can compute; with null oneDNN computes all.
/// Throws LoadError or dnnl::error.
ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const dnnl::engine& engine, const ViewEntries& entries,
                         const KernelSet* kernels);

}  // namespace bevloc::nn::onednn
