// The amplitude spectrum of features: turns with them, but does not see where they stand.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/fft128.h"

namespace bevloc {

/// |FFT2| of the features under a separable symmetric Hann window, at the top left of 128 x 128
/// zeros, not normalised. Two real channels share one complex transform.
class AmplitudeSpectrum {
 public:
  static constexpr int kRows = kFftSize;
  /// Column frequencies 0 ... 63: the other half is the point reflection of this one.
  static constexpr int kCols = kFftSize / 2;

  AmplitudeSpectrum(const BevGrid& grid, int channels);

  void compute(const CellFeatures& features);

  /// [row frequency, column frequency, lanes] of the features computed last.
  std::span<const float> amplitude() const { return amplitude_; }
  int lanes() const { return lanes_; }

 private:
  void transform_columns(const CellFeatures& features, int first_lane);
  void transform_rows(int row_frequency, int first_lane);
  void store_amplitude(int row_frequency, int own_lanes, int mirror_lanes, int first_lane);

  BevGrid grid_;
  int lanes_;
  std::vector<float> row_window_;
  std::vector<float> col_window_;
  FftTile tile_;
  std::vector<float> half_done_;  ///< [row frequency, column, lanes of one vector]
  std::vector<float> amplitude_;
};

}  // namespace bevloc
