// What the map's window holds of shifted features: the other half of a ZNCC.
#pragma once

#include <span>
#include <vector>

#include "pipeline/bev_grid.h"
#include "pipeline/solver/lanes.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {

/// Sums over the cells of a window and over channels.
struct WindowSums {
  double value = 0.0;   ///< of B
  double square = 0.0;  ///< of B^2
  // Products of B with what lies further on; they make the square of B read between cells.
  double next_col = 0.0;   ///< B(p) B(p + (0, 1))
  double next_row = 0.0;   ///< B(p) B(p + (1, 0))
  double next_both = 0.0;  ///< B(p) B(p + (1, 1))
  double across = 0.0;     ///< B(p + (0, 1)) B(p + (1, 0))

  WindowSums& operator+=(const WindowSums& other);
};

/// Energy of features under the map's window at every shift, whole or between cells.
class ShiftEnergy {
 public:
  ShiftEnergy(const BevGrid& grid, int channels, const ShiftRange& shifts);

  /// `frame` as for ShiftCorrelation::correlate().
  void set_frame(const LaneBuffer& frame);

  /// Sums of B read bilinearly at a shift: its value and its square.
  double value(const SplitShift& row, const SplitShift& col) const;
  double square(const SplitShift& row, const SplitShift& col) const;

 private:
  const WindowSums& window(int row_shift, int col_shift) const {
    return windows_[shifts_.index(row_shift, col_shift)];
  }

  BevGrid grid_;
  ShiftRange shifts_;
  int lanes_;
  std::vector<WindowSums> windows_;  ///< by ShiftRange::index()
  std::vector<WindowSums> row_;      ///< of one row of the frame, by column shift
};

}  // namespace bevloc
