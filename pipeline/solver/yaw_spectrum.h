// Yaw from amplitude spectra (paper, III-D, eq. 7 to 10), turned in frequency space.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/amplitude_spectrum.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// Yaw features: the amplitude spectrum in polar coordinates of PHYSICAL frequency (the grid is not
/// square), averaged over the radii of each of eight bands and standardised over the angle. One
/// spectrum per side: a yaw hypothesis shifts the signature of the vehicle's features along its
/// angle, because turning the features themselves would blur every hypothesis but zero.
class YawSpectrum {
 public:
  static constexpr int kBands = 8;
  static constexpr int kRadiiPerBand = 4;
  static constexpr int kAngles = 360;            ///< over half a turn: the spectrum is even
  static constexpr double kMinFrequency = 0.05;  ///< cycles per metre
  static constexpr double kMaxFrequency = 0.8;

  /// Whether every frequency that is read lies on the spectrum of such a grid.
  static bool covers(const BevGrid& grid);

  YawSpectrum(const BevGrid& grid, int channels, const HypothesisAxis& yaw_rad);

  /// scores[k] = -mean((Y_map - Y_bev turned by hypothesis k)^2).
  void score(const CellFeatures& bev, const CellFeatures& map, std::span<double> scores);

 private:
  /// Bilinear interpolation on the spectrum.
  struct Sample {
    int offsets[4];
    float weights[4];
  };

  void make_samples(const BevGrid& grid);
  void compute_signature(const CellFeatures& features, std::vector<float>& signature);
  void standardise_band(float* band) const;
  float* band(std::vector<float>& signature, int index) const;

  HypothesisAxis yaw_rad_;
  int channels_;
  int margin_;  ///< angles by which a hypothesis can shift a signature
  AmplitudeSpectrum spectrum_;
  std::vector<Sample> samples_;  ///< [band, angle, radius]
  /// [band, margin + angle + margin, lanes]; the margins repeat the other end.
  std::vector<float> bev_signature_;
  std::vector<float> map_signature_;
};

}  // namespace bevloc
