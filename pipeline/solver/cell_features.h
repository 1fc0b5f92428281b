// Features stored with the channels of a cell side by side, inside a margin of zeros.
#pragma once

#include <cstddef>
#include <span>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {

/// Layout [margin + rows + margin, margin + cols + margin, lanes]. `lanes` is the number of
/// channels rounded up to whole vectors; the extra lanes are zero. The margin is as wide as the
/// farthest hypothesis reads, so that a warp needs no bounds checks.
class CellFeatures {
 public:
  CellFeatures(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);
  /// Makes features without a margin. No hypothesis may move them.
  CellFeatures(const BevGrid& grid, int channels);

  /// Copies features [channels, rows, cols] in.
  void assign(std::span<const float> planes);

  /// Copies features [channels, rows, cols] out.
  void copy_to(std::span<float> planes) const;

  /// Sets each cell to the mean of a square block of cells of `fine`. The block is as wide as
  /// fine.grid().rows / grid().rows, rounded down; remaining cells of `fine` are ignored.
  void assign_average_of(const CellFeatures& fine);

  /// The lanes() values of a cell. Cells in the margin are allowed; their values are 0.
  const float* cell(int row, int col) const {
    return data_.data() +
           (static_cast<std::ptrdiff_t>(row + margin_) * padded_cols_ + col + margin_) * lanes_;
  }
  float* mutable_cell(int row, int col) {
    return data_.data() +
           (static_cast<std::ptrdiff_t>(row + margin_) * padded_cols_ + col + margin_) * lanes_;
  }
  std::ptrdiff_t row_stride() const { return static_cast<std::ptrdiff_t>(padded_cols_) * lanes_; }

  const BevGrid& grid() const { return grid_; }
  int channels() const { return channels_; }
  int lanes() const { return lanes_; }

 private:
  CellFeatures(const BevGrid& grid, int channels, int margin);

  BevGrid grid_;
  int channels_;
  int lanes_;
  int margin_;
  int padded_cols_;
  LaneBuffer data_;
};

}  // namespace bevloc
