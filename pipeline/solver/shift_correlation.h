// Correlation of features with the map's at every whole shift, in the frequency domain.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes_fft.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {

/// K[m, n] = sum over cells (u, v) of the map and channels of M[u, v] B[u + m, v + n], for B known
/// on a frame as wide as the shifts around the map's cells.
///
/// Two real channels a and b make one complex signal a + ib: the real part of the correlation of
/// two such signals is the sum of both channels' correlations, so nothing has to be separated. Only
/// the few shifts that are wanted are transformed back.
class ShiftCorrelation {
 public:
  ShiftCorrelation(const BevGrid& grid, int channels, const ShiftRange& shifts);

  void set_map(const CellFeatures& map);

  /// `frame`: [rows + 2 shifts.rows, cols + 2 shifts.cols, lanes], the map's cells and as many
  /// around them as the shifts reach. Writes one value for each ShiftRange::index().
  void correlate(const LaneBuffer& frame, std::span<double> correlation);

 private:
  void transform_columns(const float* frame, std::ptrdiff_t row_stride);
  void transform_rows(int first_row, int group);
  void add_shifts(int first_row, std::span<double> correlation) const;
  void add_shift(int first_row, int col_shift, const Lanes* value,
                 std::span<double> correlation) const;

  ShiftRange shifts_;
  int rows_;  ///< of a frame
  int cols_;
  int lanes_;
  LanesFft column_fft_;
  LanesFft row_fft_;
  FftTile column_tile_;
  FftTile row_tile_;
  FftTile product_;       ///< [column frequency, two row frequencies of eight pairs]
  LaneBuffer half_done_;  ///< [lane group, row frequency, column, eight real, eight imaginary]
  LaneBuffer map_;        ///< [two row frequencies, lane group, column frequency, re and im tile]
  std::vector<float> turn_of_col_;   ///< [column shift, column frequency, cos and sin]
  std::vector<double> turn_of_row_;  ///< [row frequency, row shift, cos and sin]
};

}  // namespace bevloc
