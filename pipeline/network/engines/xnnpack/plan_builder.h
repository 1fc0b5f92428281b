// Plans the execution of a program by XNNPACK: makes the tasks and determines the lifetime of each
// storage.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pipeline/network/engines/engine.h"
#include "pipeline/network/engines/xnnpack/task.h"
#include "pipeline/network/plan/memory_plan.h"

namespace bevloc::nn::xnnpack {

struct ExecutionPlan {
  std::vector<Lifetime> storages;
  std::vector<std::vector<std::unique_ptr<Task>>> branches;
  std::vector<size_t> input_storages;   ///< by program input: dense, as the model declares it
  std::vector<size_t> output_storages;  ///< by program output: dense floats
};

/// Every output must be in exactly one branch. `entries` must outlive the plan. Throws LoadError.
ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const ViewEntries& entries);

}  // namespace bevloc::nn::xnnpack
