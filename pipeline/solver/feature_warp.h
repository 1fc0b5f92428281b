// Features moved by a correction, read bilinearly, row by row.
#pragma once

#include <cmath>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {

/// Sixteen positions between cells: the offset of the cell before each along both axes, and how far
/// beyond it they are along rows and columns.
struct Taps {
  LaneIntegers offset;
  Lanes u;
  Lanes v;
};

/// A straight line of positions: number i is u0 + i du, v0 + i dv (rows and columns) from `origin`.
struct WarpLine {
  const float* origin;
  int row_stride;
  int lanes;
  double u0;
  double v0;
  double du;
  double dv;
  int cells;

  /// Of the positions from `first` on; those beyond the last cell are not to be read.
  void find_taps(int first, Taps& taps) const {
    LaneIntegers row;
    LaneIntegers col;
    split(u0 + first * du, du, row, taps.u);
    split(v0 + first * dv, dv, col, taps.v);
    taps.offset = row * row_stride + col * lanes;
  }

  /// Sixteen channels of position i of `taps`, from channel `k` on.
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
  /// Of sixteen positions: the whole cells, and what is beyond them.
  static void split(double first, double step, LaneIntegers& cells, Lanes& fraction) {
    constexpr Lanes kNumbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const double whole = std::floor(first);  // taken off, so that fractions keep their precision
    const Lanes position = static_cast<float>(first - whole) + kNumbers * static_cast<float>(step);
    const LaneIntegers towards_zero = __builtin_convertvector(position, LaneIntegers);
    const LaneIntegers below =
        towards_zero + (position < __builtin_convertvector(towards_zero, Lanes));
    fraction = position - __builtin_convertvector(below, Lanes);
    cells = below + static_cast<int>(whole);
  }
};

/// The taps of a line, sixteen after sixteen. The next ones are found before these are used, so
/// that the one hides behind the other.
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

/// Features that a correction has moved,
///
///   moved(p) = features(R(-yaw) (p - t)), bilinear, zero outside,
///
/// with t = `row_shift`, `col_shift` in cells: x / cell_m and y / cell_m.
class FeatureWarp {
 public:
  FeatureWarp(const CellFeatures& features, double yaw_rad, double row_shift = 0.0,
              double col_shift = 0.0);
  FeatureWarp(const CellFeatures& features, const Se2& correction);

  /// Where `cells` cells of `row` come from: `col_begin`, and every `col_step`-th from there on.
  /// They may lie outside the grid.
  WarpLine line(int row, int col_begin, int cells, int col_step = 1) const;

 private:
  const CellFeatures& features_;
  double cos_yaw_;
  double sin_yaw_;
  double row_shift_;
  double col_shift_;
};

inline WarpLine FeatureWarp::line(int row, int col_begin, int cells, int col_step) const {
  // Rows grow towards -x and columns towards -y, so a turn of (x, y) is the same turn of (u, v),
  // and a shift by +x reads rows further on.
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

/// Writes the cells * lanes values of a line.
void warp(const WarpLine& line, float* out);

}  // namespace bevloc
