// Sums of shifted features and their squares over the map's window, which ZNCC needs.
#pragma once

#include <span>
#include <vector>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/lanes.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {

/// Sums over the cells p of a window and over the channels of B.
struct WindowSums {
  double value = 0.0;   ///< B(p)
  double square = 0.0;  ///< B(p)^2
  // Products of neighbouring cells, for the square of B interpolated between cells.
  double next_col = 0.0;   ///< B(p) B(p + (0, 1))
  double next_row = 0.0;   ///< B(p) B(p + (1, 0))
  double next_both = 0.0;  ///< B(p) B(p + (1, 1))
  double across = 0.0;     ///< B(p + (0, 1)) B(p + (1, 0))

  WindowSums& operator+=(const WindowSums& other);
};

/// Computes the sums of shifted features B over the cells of the map, at every shift in the range,
/// whole or fractional. The constructor allocates all memory. One thread.
class ShiftEnergy {
 public:
  ShiftEnergy(const BevGrid& grid, int channels, const ShiftRange& shifts);

  /// Computes the sums at all whole shifts. `frame` is B with a border, as for
  /// ShiftCorrelation::correlate(), followed by one cell that is read with weight zero.
  void set_frame(const LaneBuffer& frame);

  /// Sum of B, or of its square, with B shifted and interpolated bilinearly.
  double value(const SplitShift& row, const SplitShift& col) const;
  double square(const SplitShift& row, const SplitShift& col) const;

 private:
  const WindowSums& window(int row_shift, int col_shift) const {
    return windows_[shifts_.index(row_shift, col_shift)];
  }

  BevGrid grid_;
  ShiftRange shifts_;
  int lanes_;
  std::vector<WindowSums> windows_;  ///< sums by ShiftRange::index()
  std::vector<WindowSums> row_;      ///< sums over one row of the frame, by column shift
};

}  // namespace bevloc
