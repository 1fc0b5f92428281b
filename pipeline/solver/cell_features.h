// Features with the channels of a cell side by side, in a frame of zeros.
#pragma once

#include <span>
#include <vector>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/lanes.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// [margin + rows + margin, margin + cols + margin, lanes]: the channels, rounded up to whole
/// vectors with zeros. The margin is as wide as any hypothesis reaches, so that a warp never has to
/// ask whether it is still inside.
class CellFeatures {
 public:
  CellFeatures(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses);
  /// Without a margin, for features that are never moved.
  CellFeatures(const BevGrid& grid, int channels);

  /// Takes features [channels, rows, cols].
  void assign(std::span<const float> planes);

  /// The reverse: writes features [channels, rows, cols].
  void copy_to(std::span<float> planes) const;

  /// Takes the means of whole blocks of finer cells, as many as go into one of these.
  void assign_average_of(const CellFeatures& fine);

  /// The `lanes()` values of a cell; in the margin they are zero.
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
