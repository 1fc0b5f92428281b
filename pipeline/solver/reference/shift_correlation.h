// Cross-correlation of BEV and map features at every whole shift, by Fourier transform.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/reference/lanes_fft.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {

/// K[m, n] = sum over channels and cells (u, v) of the map of M[u, v] B[u + m, v + n]. B is given
/// on the map's cells and a border as wide as the largest shifts.
///
/// Two real channels a and b form one complex signal a + ib. The real part of the correlation of
/// two such signals is the sum of the correlations of both channels, so they need not be separated.
/// Only the few shifts in the range are transformed back. The constructor allocates all memory. One
/// thread.
class ShiftCorrelation {
 public:
  ShiftCorrelation(const BevGrid& grid, int channels, const ShiftRange& shifts);

  void set_map(const CellFeatures& map);

  /// Writes K by ShiftRange::index(). `frame` is B: the cells of the grid with a border as wide as
  /// the largest shifts, [rows + 2 shifts.rows, cols + 2 shifts.cols, lanes].
  void correlate(const LaneBuffer& frame, std::span<double> correlation);

 private:
  void transform_columns(const float* frame, std::ptrdiff_t row_stride);
  void transform_rows(int first_row, int group);
  void add_shifts(int first_row, std::span<double> correlation) const;
  void add_shift(int first_row, int col_shift, const Lanes* value,
                 std::span<double> correlation) const;

  ShiftRange shifts_;
  int rows_;  ///< rows of a frame with its border
  int cols_;
  int lanes_;
  LanesFft column_fft_;
  LanesFft row_fft_;
  FftTile column_tile_;
  FftTile row_tile_;
  FftTile product_;  ///< [column frequency, two row frequencies of eight pairs]
  /// [lane group, row frequency, column, eight real and eight imaginary parts]
  LaneBuffer half_transformed_;
  /// [two row frequencies, lane group, column frequency, real and imaginary part, kLanes]
  LaneBuffer map_;
  std::vector<float> col_phase_;   ///< [column shift, column frequency, cos and sin]
  std::vector<double> row_phase_;  ///< [row frequency, row shift, cos and sin]
};

}  // namespace bevloc
