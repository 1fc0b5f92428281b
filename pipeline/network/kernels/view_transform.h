// The view transform: computes each BEV cell as a weighted sum of at most eight image features.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/network/model/graph.h"
#include "pipeline/network/view/view_table.h"

namespace bevloc::nn {

/// A view table reordered cell by cell, without the entries of weight zero.
class ViewEntries {
 public:
  explicit ViewEntries(int cells);

  /// Copies `table`, which must have the same number of cells. Does not allocate.
  void set(const ViewTable& table);

  int cells() const { return static_cast<int>(first_.size()) - 1; }

  /// The entries of cell c are those from first()[c] up to, not including, first()[c + 1].
  const int32_t* first() const { return first_.data(); }
  const int32_t* index() const { return index_.data(); }
  const float* weight() const { return weight_.data(); }

 private:
  std::vector<int32_t> first_;
  std::vector<int32_t> index_;
  std::vector<float> weight_;
};

/// For each cell in [begin, end) and each channel, computes
///   bev[cell][channel] = scale * sum over the cell's entries of weight * features[index][channel].
/// Rounds to nearest even and saturates if the output is uint8 or int8. Input and output elements
/// are uint8, int8 or float. Sums in the order of the table and without fused multiply-add, so that
/// every CPU gives the same result.
void gather_view(const ViewEntries& entries, ElementType input_type, const std::byte* features,
                 int channels, float scale, int begin, int end, ElementType output_type,
                 std::byte* bev);

}  // namespace bevloc::nn
