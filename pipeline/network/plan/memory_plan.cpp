#include "pipeline/network/plan/memory_plan.h"

#include <algorithm>
#include <numeric>

namespace bevloc::nn {
namespace {

bool are_in_use_together(const Lifetime& a, const Lifetime& b) {
  return a.first <= b.last && b.first <= a.last;
}

size_t rounded_up_to_alignment(size_t bytes) {
  return (bytes + kBufferAlignment - 1) / kBufferAlignment * kBufferAlignment;
}

}  // namespace

MemoryPlan plan_memory(std::span<const Lifetime> buffers) {
  std::vector<size_t> largest_first(buffers.size());
  std::iota(largest_first.begin(), largest_first.end(), size_t{0});
  std::ranges::stable_sort(largest_first, [&buffers](size_t a, size_t b) {
    return buffers[a].bytes > buffers[b].bytes;
  });

  MemoryPlan plan;
  plan.offsets.resize(buffers.size());
  std::vector<size_t> placed_by_offset;
  for (const size_t buffer : largest_first) {
    const size_t bytes = rounded_up_to_alignment(buffers[buffer].bytes);
    size_t offset = 0;
    for (const size_t other : placed_by_offset) {
      if (!are_in_use_together(buffers[buffer], buffers[other])) continue;
      if (offset + bytes <= plan.offsets[other]) break;
      offset =
          std::max(offset, plan.offsets[other] + rounded_up_to_alignment(buffers[other].bytes));
    }
    plan.offsets[buffer] = offset;
    plan.total_bytes = std::max(plan.total_bytes, offset + bytes);
    placed_by_offset.insert(
        std::ranges::upper_bound(placed_by_offset, offset, {},
                                 [&plan](size_t placed) { return plan.offsets[placed]; }),
        buffer);
  }
  return plan;
}

}  // namespace bevloc::nn
