// Shifts of the hypotheses, in whole cells and fractions.
#pragma once

#include <algorithm>
#include <cmath>

#include "pipeline/solver/hypotheses.h"

namespace bevloc {

/// A shift that differs from a whole number of cells by less than this counts as whole.
inline constexpr double kWholeShiftTolerance = 1e-9;

/// The whole shifts -rows ... +rows and -cols ... +cols that enclose all hypotheses.
struct ShiftRange {
  int rows = 0;
  int cols = 0;

  int row_count() const { return 2 * rows + 1; }
  int col_count() const { return 2 * cols + 1; }
  int index(int row_shift, int col_shift) const {
    return (row_shift + rows) * col_count() + col_shift + cols;
  }
};

/// Cells that cover `range_m`.
inline int whole_cells(double range_m, double cell_m) {
  return static_cast<int>(std::ceil(range_m / cell_m - kWholeShiftTolerance));
}

inline ShiftRange shift_range(const HypothesisGrid& hypotheses, double cell_m) {
  return {whole_cells(hypotheses.x_m.farthest(), cell_m),
          whole_cells(hypotheses.y_m.farthest(), cell_m)};
}

/// A shift in cells: whole + fraction, with 0 <= fraction < 1.
struct SplitShift {
  int whole = 0;
  double fraction = 0.0;
};

inline SplitShift split_shift(double cells) {
  const double whole = std::floor(cells + kWholeShiftTolerance);
  return {static_cast<int>(whole), std::max(cells - whole, 0.0)};
}

}  // namespace bevloc
