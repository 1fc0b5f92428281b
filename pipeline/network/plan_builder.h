// From a program to tasks on buffers: chooses memory layouts and oneDNN primitives, and finds out
// from when to when each buffer is needed.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/network/memory_plan.h"
#include "pipeline/network/program.h"
#include "pipeline/network/task.h"

namespace bevloc::nn {

/// Output names that are computed together. A branch may read what earlier branches computed.
using Branch = std::vector<std::string>;

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

/// Every output must be in exactly one branch. `entries` must outlive the plan.
/// Throws LoadError or dnnl::error.
ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const dnnl::engine& engine, const ViewEntries& entries);

}  // namespace bevloc::nn
