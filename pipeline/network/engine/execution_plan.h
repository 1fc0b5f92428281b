// The result of planning for oneDNN: buffers, their lifetimes, and the tasks of each branch.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/network/engine/task.h"
#include "pipeline/network/plan/memory_plan.h"

namespace bevloc::nn::onednn {

struct ExecutionPlan {
  struct Buffer {
    MemoryDesc desc;
    size_t storage = 0;  ///< index in `storages`; several buffers may use one storage
  };

  std::vector<Buffer> buffers;
  std::vector<Lifetime> storages;
  std::vector<std::vector<std::unique_ptr<Task>>> branches;
  std::vector<int> input_buffers;   ///< by program input: dense, as the model declares it
  std::vector<int> output_buffers;  ///< by program output: dense floats
  size_t scratchpad_bytes = 0;      ///< the largest scratchpad that a primitive needs
};

}  // namespace bevloc::nn::onednn
