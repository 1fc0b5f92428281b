// Places buffers in one arena so that those that are never needed together share memory.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bevloc::nn {

/// A buffer that is needed from task `first` to task `last`, both included.
struct Lifetime {
  size_t bytes = 0;
  int first = 0;
  int last = 0;
};

struct MemoryPlan {
  std::vector<size_t> offsets;  ///< one per buffer, multiples of kBufferAlignment
  size_t total_bytes = 0;
};

inline constexpr size_t kBufferAlignment = 64;

/// Largest first, each at the lowest offset where it meets no contemporary.
MemoryPlan plan_memory(std::span<const Lifetime> buffers);

}  // namespace bevloc::nn
