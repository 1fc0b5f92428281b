// The amplitude spectrum of features: turns with them, but does not see where they stand.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/lanes_fft.h"

namespace bevloc {

enum class Window { kNone, kHann };

/// |FFT2| of features under a separable symmetric window, at the top left of rows x cols zeros, not
/// normalised. Two sides share one complex transform: one is its real part, the other its imaginary
/// part.
class AmplitudeSpectrum {
 public:
  /// `rows` and `cols` are lengths that LanesFft supports, at least the grid's. Amplitudes of more
  /// than `farthest` bins from zero are never written.
  AmplitudeSpectrum(const BevGrid& grid, int channels, int rows, int cols, Window window,
                    double farthest);

  void compute(const CellFeatures& first, const CellFeatures& second);

  /// [row frequency, column frequency, lanes] of the features computed last, 0 or 1. Column
  /// frequencies 0 ... cols / 2: the others are the point reflection of these.
  std::span<const float> amplitude(size_t side) const { return amplitude_[side]; }
  /// Where in amplitude() the lanes of a frequency begin; the row frequency may be negative.
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
  std::vector<int> cols_to_store_;  ///< of each row frequency
  LanesFft column_fft_;
  LanesFft row_fft_;
  FftTile column_tile_;
  FftTile own_row_;
  FftTile mirror_row_;
  LaneBuffer half_done_;  ///< [row frequency, column, real and imaginary lanes of one vector]
  std::array<LaneBuffer, 2> amplitude_;
};

}  // namespace bevloc
