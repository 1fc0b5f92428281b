#include "pipeline/network/kernels/view_transform.h"

#include <cassert>

#include "pipeline/network/kernels/view_gather.h"

namespace bevloc::nn {

ViewEntries::ViewEntries(int cells)
    : first_(static_cast<size_t>(cells) + 1),
      index_(static_cast<size_t>(cells) * kViewSlots),
      weight_(static_cast<size_t>(cells) * kViewSlots) {}

void ViewEntries::set(const ViewTable& table) {
  const size_t cell_count = static_cast<size_t>(cells());
  assert(table.index.size() == kViewSlots * cell_count);
  assert(table.weight.size() == kViewSlots * cell_count);
  int32_t entry = 0;
  for (size_t cell = 0; cell < cell_count; ++cell) {
    first_[cell] = entry;
    for (size_t slot = 0; slot < kViewSlots; ++slot) {
      const size_t from = slot * cell_count + cell;
      if (table.weight[from] == 0.0F) continue;
      index_[entry] = table.index[from];
      weight_[entry] = table.weight[from];
      ++entry;
    }
  }
  first_[cell_count] = entry;
}

void gather_view(const ViewEntries& entries, ElementType input_type, const std::byte* features,
                 int channels, float scale, int begin, int end, ElementType output_type,
                 std::byte* bev) {
  gather_for(input_type, output_type)(entries, features, channels, scale, begin, end, bev);
}

}  // namespace bevloc::nn
