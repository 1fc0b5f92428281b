// The view transform's kernel: each BEV cell is a weighted sum of a few image features.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/network/graph.h"
#include "pipeline/network/view_table.h"

namespace bevloc::nn {

/// The view table cell by cell, without its zero weights.
class ViewEntries {
 public:
  explicit ViewEntries(int cells);

  /// `table` must be for as many cells. Allocates nothing.
  void set(const ViewTable& table);

  int cells() const { return static_cast<int>(first_.size()) - 1; }

  /// The entries of cell c are first()[c] to first()[c + 1].
  const int32_t* first() const { return first_.data(); }
  const int32_t* index() const { return index_.data(); }
  const float* weight() const { return weight_.data(); }

 private:
  std::vector<int32_t> first_;
  std::vector<int32_t> index_;
  std::vector<float> weight_;
};

/// For the cells from `begin` up to `end`:
/// bev[cell][channel] = scale * sum over the cell's entries of weight * features[index][channel],
/// rounded to nearest even and saturated where the output is 8 bits wide. Summed in the table's
/// order and without fused multiply-add: every CPU gives the same result. Elements are uint8, int8
/// or float.
void gather_view(const ViewEntries& entries, ElementType input_type, const std::byte* features,
                 int channels, float scale, int begin, int end, ElementType output_type,
                 std::byte* bev);

}  // namespace bevloc::nn
