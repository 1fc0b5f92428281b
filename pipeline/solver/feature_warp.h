// Reads features as a correction moves them, by bilinear interpolation, row by row.
#pragma once

#include <cmath>

#include "common/se2.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {

/// How to interpolate at kLanes positions. Each lies between four cells; the first one is at the
/// whole row and the whole column at or before the position.
struct Taps {
  LaneIntegers offset;  ///< offset of the first cell in floats
  Lanes first;          ///< weight of the first cell
  Lanes next_col;       ///< weight of the cell in the next column
  Lanes next_row;       ///< weight of the cell in the next row
  Lanes next_both;      ///< weight of the cell in the next row and column
};

/// Splits positions into whole cells and fractions.
inline void split(const Lanes& position, LaneIntegers& cells, Lanes& fraction) {
  const LaneIntegers towards_zero = __builtin_convertvector(position, LaneIntegers);
  cells = towards_zero + (position < __builtin_convertvector(towards_zero, Lanes));
  fraction = position - __builtin_convertvector(cells, Lanes);
}

/// Where moved features are read. The taps of positions that are not wanted must not be read.
struct WarpSource {
  const float* origin;  ///< the features of cell (0, 0)
  int row_stride;
  int lanes;

  /// Sets the taps of positions that are counted from cell (row, col).
  void set_taps(const Lanes& rows_beyond, int row, const Lanes& cols_beyond, int col,
                Taps& taps) const {
    LaneIntegers row_cells;
    LaneIntegers col_cells;
    Lanes u;
    Lanes v;
    split(rows_beyond, row_cells, u);
    split(cols_beyond, col_cells, v);
    taps.offset = row_cells * row_stride + col_cells * lanes + (row * row_stride + col * lanes);
    taps.next_both = u * v;
    taps.next_row = u - taps.next_both;
    taps.next_col = v - taps.next_both;
    taps.first = 1.0F - u - taps.next_col;
  }

  /// Reads kLanes channels, from channel `k` on, at position i of `taps`.
  void read(const Taps& taps, int i, int k, Lanes& value) const {
    const float* upper = origin + taps.offset[i] + k;
    const float* lower = upper + row_stride;
    value =
        (taps.first[i] * bevloc::lanes(upper) + taps.next_col[i] * bevloc::lanes(upper + lanes)) +
        (taps.next_row[i] * bevloc::lanes(lower) +
         taps.next_both[i] * bevloc::lanes(lower + lanes));
  }
};

/// A number as a whole number and a fraction, so that floats hold precise fractions.
struct SplitNumber {
  explicit SplitNumber(double number)
      : whole(static_cast<int>(std::floor(number))), fraction(static_cast<float>(number - whole)) {}
  int whole;
  float fraction;
};

/// Equally spaced positions on a straight line: position i lies at row u0 + i du and column
/// v0 + i dv.
struct WarpLine {
  WarpSource source;
  double u0;
  double v0;
  double du;
  double dv;
  int cells;

  /// Finds the taps of the kLanes positions from `first` on.
  void find_taps(int first, Taps& taps) const {
    constexpr Lanes kNumbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const SplitNumber u(u0 + first * du);
    const SplitNumber v(v0 + first * dv);
    source.set_taps(u.fraction + kNumbers * static_cast<float>(du), u.whole,
                    v.fraction + kNumbers * static_cast<float>(dv), v.whole, taps);
  }
};

/// Positions anywhere: a cell `row` rows and `col` columns away from the middle of the grid is read
/// at row cos row + sin col + row_base and column cos col - sin row + col_base.
struct WarpPlane {
  WarpSource source;
  float cos_yaw;
  float sin_yaw;
  SplitNumber row_base;
  SplitNumber col_base;

  void find_taps(const Lanes& row, const Lanes& col, Taps& taps) const {
    source.set_taps(cos_yaw * row + sin_yaw * col + row_base.fraction, row_base.whole,
                    cos_yaw * col - sin_yaw * row + col_base.fraction, col_base.whole, taps);
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
  /// Where any moved cell is read.
  WarpPlane plane() const;

 private:
  WarpSource source() const {
    return {.origin = features_.cell(0, 0),
            .row_stride = static_cast<int>(features_.row_stride()),
            .lanes = features_.lanes()};
  }

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
  return {.source = source(),
          .u0 = cos_yaw_ * u + sin_yaw_ * v + center_row,
          .v0 = -sin_yaw_ * u + cos_yaw_ * v + center_col,
          .du = col_step * sin_yaw_,
          .dv = col_step * cos_yaw_,
          .cells = cells};
}

inline WarpPlane FeatureWarp::plane() const {
  const double center_row = 0.5 * (features_.grid().rows - 1);
  const double center_col = 0.5 * (features_.grid().cols - 1);
  return {
      .source = source(),
      .cos_yaw = static_cast<float>(cos_yaw_),
      .sin_yaw = static_cast<float>(sin_yaw_),
      .row_base = SplitNumber(cos_yaw_ * row_shift_ + sin_yaw_ * col_shift_ + center_row),
      .col_base = SplitNumber(cos_yaw_ * col_shift_ - sin_yaw_ * row_shift_ + center_col),
  };
}

/// Writes the values of a line: its cells, and for each the lanes of the features.
void warp(const WarpLine& line, float* out);

/// Writes all cells of the grid, moved by `correction`. Their rows are `row_stride` floats apart.
void warp_all(const CellFeatures& features, const Se2& correction, float* out,
              std::ptrdiff_t row_stride);

}  // namespace bevloc
