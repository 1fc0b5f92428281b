// Reads features as a correction moves them, by bilinear interpolation, row by row.
#pragma once

#include <cmath>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {

/// Bilinear taps of kLanes positions between cells.
struct Taps {
  LaneIntegers offset;  ///< of the cell at the whole row and column at or before the position
  Lanes u;              ///< fraction of a row beyond that cell
  Lanes v;              ///< fraction of a column beyond that cell
};

/// Equally spaced positions on a straight line: position i lies at row u0 + i du and column
/// v0 + i dv.
struct WarpLine {
  const float* origin;  ///< the features of cell (0, 0)
  int row_stride;
  int lanes;
  double u0;
  double v0;
  double du;
  double dv;
  int cells;

  /// Finds the taps of the kLanes positions from `first` on. Taps beyond position cells - 1 must
  /// not be read.
  void find_taps(int first, Taps& taps) const {
    LaneIntegers row;
    LaneIntegers col;
    split(u0 + first * du, du, row, taps.u);
    split(v0 + first * dv, dv, col, taps.v);
    taps.offset = row * row_stride + col * lanes;
  }

  /// Reads kLanes channels, from channel `k` on, at position i of `taps`.
  void read(const Taps& taps, int i, int k, Lanes& value) const {
    const float* first = origin + taps.offset[i] + k;
    const float* second = first + row_stride;
    const Lanes& near_upper = bevloc::lanes(first);
    const Lanes& near_lower = bevloc::lanes(second);
    const Lanes upper = near_upper + taps.v[i] * (bevloc::lanes(first + lanes) - near_upper);
    const Lanes lower = near_lower + taps.v[i] * (bevloc::lanes(second + lanes) - near_lower);
    value = upper + taps.u[i] * (lower - upper);
  }

 private:
  /// Splits the kLanes positions first, first + step, ... into whole cells and fractions.
  static void split(double first, double step, LaneIntegers& cells, Lanes& fraction) {
    constexpr Lanes kNumbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const double whole = std::floor(first);  // subtracted, so that floats hold precise fractions
    const Lanes position = static_cast<float>(first - whole) + kNumbers * static_cast<float>(step);
    const LaneIntegers towards_zero = __builtin_convertvector(position, LaneIntegers);
    const LaneIntegers below =
        towards_zero + (position < __builtin_convertvector(towards_zero, Lanes));
    fraction = position - __builtin_convertvector(below, Lanes);
    cells = below + static_cast<int>(whole);
  }
};

/// Iterates over the taps of a line, kLanes at a time. It finds the next taps before the current
/// ones are used, so that the processor overlaps the two.
class TapGroups {
 public:
  explicit TapGroups(const WarpLine& line) : line_(line) { line.find_taps(0, taps_[0]); }

  const Taps& next() {
    const Taps& current = taps_[group_ % 2];
    ++group_;
    const int first = group_ * kLanes;
    if (first < line_.cells) line_.find_taps(first, taps_[group_ % 2]);
    return current;
  }

 private:
  const WarpLine& line_;
  Taps taps_[2];
  int group_ = 0;
};

/// Features moved by a rotation and a translation t:
///
///   moved(p) = features(R(-yaw) (p - t)), bilinear, zero outside the grid.
///
/// `row_shift` = x / cell_m and `col_shift` = y / cell_m are t in cells. The features must outlive
/// the warp and have a margin that covers the movement (CellFeatures).
class FeatureWarp {
 public:
  FeatureWarp(const CellFeatures& features, double yaw_rad, double row_shift = 0.0,
              double col_shift = 0.0);
  FeatureWarp(const CellFeatures& features, const Se2& correction);

  /// Where the moved cells of `row` are read: `cells` cells, from column `col_begin` on in steps of
  /// `col_step`. The cells may lie outside the grid.
  WarpLine line(int row, int col_begin, int cells, int col_step = 1) const;

 private:
  const CellFeatures& features_;
  double cos_yaw_;
  double sin_yaw_;
  double row_shift_;
  double col_shift_;
};

inline WarpLine FeatureWarp::line(int row, int col_begin, int cells, int col_step) const {
  // Rows grow towards -x and columns towards -y. A rotation of (x, y) is therefore the same
  // rotation of (u, v), and a shift by +x reads higher rows.
  const double center_row = 0.5 * (features_.grid().rows - 1);
  const double center_col = 0.5 * (features_.grid().cols - 1);
  const double u = row - center_row + row_shift_;
  const double v = col_begin - center_col + col_shift_;
  return {.origin = features_.cell(0, 0),
          .row_stride = static_cast<int>(features_.row_stride()),
          .lanes = features_.lanes(),
          .u0 = cos_yaw_ * u + sin_yaw_ * v + center_row,
          .v0 = -sin_yaw_ * u + cos_yaw_ * v + center_col,
          .du = col_step * sin_yaw_,
          .dv = col_step * cos_yaw_,
          .cells = cells};
}

/// Writes the line.cells * line.lanes values of a line.
void warp(const WarpLine& line, float* out);

}  // namespace bevloc
