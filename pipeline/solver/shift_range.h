// Whole-cell shifts that the hypotheses of a grid can read.
#pragma once

#include <algorithm>
#include <cmath>

#include "pipeline/solver/solver.h"

namespace bevloc {

/// Shifts that differ from whole cells by less are whole.
inline constexpr double kWholeShiftTolerance = 1e-9;

/// Shifts -rows ... +rows and -cols ... +cols: those of the hypotheses, rounded outwards.
struct ShiftRange {
  int rows = 0;
  int cols = 0;

  int row_count() const { return 2 * rows + 1; }
  int col_count() const { return 2 * cols + 1; }
  int index(int row_shift, int col_shift) const {
    return (row_shift + rows) * col_count() + col_shift + cols;
  }
};

inline int whole_cells(double range_m, double cell_m) {
  return static_cast<int>(std::ceil(range_m / cell_m - kWholeShiftTolerance));
}

inline ShiftRange shift_range(const HypothesisGrid& hypotheses, double cell_m) {
  return {whole_cells(hypotheses.x_m.farthest(), cell_m),
          whole_cells(hypotheses.y_m.farthest(), cell_m)};
}

/// A shift between two whole ones.
struct SplitShift {
  int whole = 0;
  double fraction = 0.0;
};

inline SplitShift split_shift(double cells) {
  const double whole = std::floor(cells + kWholeShiftTolerance);
  return {static_cast<int>(whole), std::max(cells - whole, 0.0)};
}

}  // namespace bevloc
