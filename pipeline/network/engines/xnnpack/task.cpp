#include "pipeline/network/engines/xnnpack/task.h"

#include <algorithm>

namespace bevloc::nn::xnnpack {

void LoopTask::bind(std::span<std::byte* const> storages, pthreadpool_t) {
  from_ = storages[input_];
  to_ = storages[output_];
}

void LoopTask::run(pthreadpool_t threads) {
  if (threads == nullptr) return run_range(0, count_);
  pthreadpool_parallelize_1d_tile_1d(
      threads, [this](size_t begin, size_t size) { run_range(begin, begin + size); }, count_,
      block_, PTHREADPOOL_FLAG_YIELD_WORKERS);
}

}  // namespace bevloc::nn::xnnpack
