// Places buffers in one arena, so that buffers that are never in use at the same time share memory.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bevloc::nn {

/// A buffer that is in use from task `first` to task `last`, inclusive.
struct Lifetime {
  size_t bytes = 0;
  int first = 0;
  int last = 0;
};

struct MemoryPlan {
  std::vector<size_t> offsets;  ///< one per buffer, a multiple of kBufferAlignment
  size_t total_bytes = 0;
};

inline constexpr size_t kBufferAlignment = 64;

/// Places the largest buffers first, each at the lowest offset where it overlaps no buffer that is
/// in use at the same time.
MemoryPlan plan_memory(std::span<const Lifetime> buffers);

}  // namespace bevloc::nn
