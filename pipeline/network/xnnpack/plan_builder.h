// From a program to tasks on storages, and from when to when each storage is needed.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pipeline/network/engine.h"
#include "pipeline/network/memory_plan.h"
#include "pipeline/network/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

struct ExecutionPlan {
  std::vector<Lifetime> storages;
  std::vector<std::vector<std::unique_ptr<Task>>> branches;
  std::vector<size_t> input_storages;   ///< as the program's inputs: dense, as the model says
  std::vector<size_t> output_storages;  ///< as the program's outputs: dense floats
};

/// Every output must be in exactly one branch. `entries` must outlive the plan. Throws LoadError.
ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const ViewEntries& entries);

}  // namespace bevloc::nn::xnnpack
