// The amplitude spectrum of features. It rotates with them and does not depend on their position.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/reference/lanes_fft.h"

namespace bevloc {

enum class Window { kNone, kHann };

/// Computes |FFT2| per channel, not normalised. The features are multiplied by a separable
/// symmetric window and padded with zeros to rows x cols. Two sides share one complex transform:
/// one is its real part, the other its imaginary part. The constructor allocates all memory. One
/// thread.
class AmplitudeSpectrum {
 public:
  /// `rows` and `cols` must be supported by LanesFft and no smaller than the grid's. Amplitudes
  /// more than `farthest` bins from frequency zero are not computed.
  AmplitudeSpectrum(const BevGrid& grid, int channels, int rows, int cols, Window window,
                    double farthest);

  void compute(const CellFeatures& first, const CellFeatures& second);

  /// Amplitudes [row frequency, column frequency, lanes] of the latest `first` (side 0) or `second`
  /// (side 1). Column frequencies are 0 ... cols / 2; the others are their point reflections.
  std::span<const float> amplitude(size_t side) const { return amplitude_[side]; }
  /// Offset in amplitude() of the first lane of a frequency. The row frequency may be negative.
  int offset(int row_frequency, int col_frequency) const {
    return ((row_frequency + rows()) % rows() * stored_cols_ + col_frequency) * lanes_;
  }
  int rows() const { return column_fft_.length(); }
  int cols() const { return row_fft_.length(); }
  int lanes() const { return lanes_; }

 private:
  void transform_column(const CellFeatures& first, const CellFeatures& second, int col,
                        int first_lane);
  void transform_row(int row_frequency, FftTile& tile);
  void store_amplitudes(int row_frequency, const FftTile& own, const FftTile& mirror,
                        int first_lane);

  BevGrid grid_;
  int lanes_;
  int stored_cols_;
  std::vector<float> row_window_;
  std::vector<float> col_window_;
  std::vector<int> cols_to_store_;  ///< per row frequency
  LanesFft column_fft_;
  LanesFft row_fft_;
  FftTile column_tile_;
  FftTile own_row_;
  FftTile mirror_row_;
  LaneBuffer half_transformed_;  ///< [row frequency, column, real and imaginary part, kLanes]
  std::array<LaneBuffer, 2> amplitude_;
};

}  // namespace bevloc
