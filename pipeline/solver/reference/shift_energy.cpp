#include "pipeline/solver/reference/shift_energy.h"

#include <algorithm>

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// WindowSums, separately for each lane.
struct LaneWindowSums {
  Lanes value = {};
  Lanes square = {};
  Lanes next_col = {};
  Lanes next_row = {};
  Lanes next_both = {};
  Lanes across = {};
};

/// Adds `sign` times the products of the cell at `b`. `below` is the cell in the next row.
inline void add_cell(const float* b, const float* below, int lane_count, float sign,
                     LaneWindowSums& sums) {
  for (int k = 0; k < lane_count; k += kLanes) {
    const Lanes own = sign * lanes(b + k);
    sums.value += own;
    sums.square += own * lanes(b + k);
    sums.next_col += own * lanes(b + lane_count + k);
    sums.next_row += own * lanes(below + k);
    sums.next_both += own * lanes(below + lane_count + k);
    sums.across += sign * lanes(b + lane_count + k) * lanes(below + k);
  }
}

/// Writes, for each column shift, the sums over the `window` cells of a row that it covers. The
/// window slides: each shift subtracts one cell and adds one.
BEVLOC_TARGET_CLONES void sum_row(const float* row, const float* below, int lane_count, int window,
                                  int shifts, WindowSums* out) {
  LaneWindowSums sums;
  for (int i = 0; i < window; ++i) {
    add_cell(row + i * lane_count, below + i * lane_count, lane_count, 1.0F, sums);
  }
  for (int n = 0;; ++n) {
    out[n] = {sum_of(sums.value),    sum_of(sums.square),    sum_of(sums.next_col),
              sum_of(sums.next_row), sum_of(sums.next_both), sum_of(sums.across)};
    if (n + 1 == shifts) return;
    const int last = (n + window) * lane_count;
    add_cell(row + n * lane_count, below + n * lane_count, lane_count, -1.0F, sums);
    add_cell(row + last, below + last, lane_count, 1.0F, sums);
  }
}

}  // namespace

WindowSums& WindowSums::operator+=(const WindowSums& other) {
  value += other.value;
  square += other.square;
  next_col += other.next_col;
  next_row += other.next_row;
  next_both += other.next_both;
  across += other.across;
  return *this;
}

ShiftEnergy::ShiftEnergy(const BevGrid& grid, int channels, const ShiftRange& shifts)
    : grid_(grid),
      shifts_(shifts),
      lanes_(round_up_to_lanes(channels)),
      windows_(static_cast<size_t>(shifts.row_count()) * shifts.col_count()),
      row_(shifts.col_count()) {}

void ShiftEnergy::set_frame(const LaneBuffer& frame) {
  std::ranges::fill(windows_, WindowSums{});
  const int frame_rows = grid_.rows + 2 * shifts_.rows;
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(grid_.cols + 2 * shifts_.cols) * lanes_;
  for (int row = 0; row < frame_rows; ++row) {
    // The row after the last one is read with weight zero, so any row may stand in for it.
    const float* cells = frame.data() + row * stride;
    const float* below = row + 1 < frame_rows ? cells + stride : cells;
    sum_row(cells, below, lanes_, grid_.cols, shifts_.col_count(), row_.data());
    const int first_shift = std::max(row - grid_.rows + 1, 0);
    const int last_shift = std::min(row, 2 * shifts_.rows);
    for (int m = first_shift; m <= last_shift; ++m) {
      for (int n = 0; n < shifts_.col_count(); ++n) {
        windows_[m * shifts_.col_count() + n] += row_[n];
      }
    }
  }
}

double ShiftEnergy::value(const SplitShift& row, const SplitShift& col) const {
  const int m = row.whole;
  const int n = col.whole;
  const int next_m = std::min(m + 1, shifts_.rows);
  const int next_n = std::min(n + 1, shifts_.cols);
  const double fr = row.fraction;
  const double fc = col.fraction;
  return (1.0 - fr) * ((1.0 - fc) * window(m, n).value + fc * window(m, next_n).value) +
         fr * ((1.0 - fc) * window(next_m, n).value + fc * window(next_m, next_n).value);
}

double ShiftEnergy::square(const SplitShift& row, const SplitShift& col) const {
  const WindowSums& here = window(row.whole, col.whole);
  const WindowSums& right = window(row.whole, std::min(col.whole + 1, shifts_.cols));
  const WindowSums& below = window(std::min(row.whole + 1, shifts_.rows), col.whole);
  const WindowSums& both =
      window(std::min(row.whole + 1, shifts_.rows), std::min(col.whole + 1, shifts_.cols));
  const double a = (1.0 - row.fraction) * (1.0 - col.fraction);
  const double b = (1.0 - row.fraction) * col.fraction;
  const double c = row.fraction * (1.0 - col.fraction);
  const double d = row.fraction * col.fraction;
  return a * a * here.square + b * b * right.square + c * c * below.square + d * d * both.square +
         2.0 * (a * b * here.next_col + c * d * below.next_col + a * c * here.next_row +
                b * d * right.next_row + a * d * here.next_both + b * c * here.across);
}

}  // namespace bevloc
