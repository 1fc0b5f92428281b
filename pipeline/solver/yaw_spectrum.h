// Yaw from amplitude spectra (paper, III-D, eq. 7 to 10), turned in frequency space.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pipeline/solver/amplitude_spectrum.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// Where the spectrum is read, and how much that counts.
struct YawTap {
  int offset = 0;
  float weight = 0.0F;
};

/// Yaw features: the amplitude spectrum in polar coordinates of PHYSICAL frequency (the grid is not
/// square), averaged over the radii of each of eight bands and standardised over the angle. One
/// spectrum per side: a yaw hypothesis shifts the signature of the vehicle's features along its
/// angle, because turning the features themselves would blur every hypothesis but zero.
///
/// The bands end below what cells of 0.6 m can hold, so finer features are averaged to such cells
/// first. A frequency beyond what coarser cells can hold is read as what it aliases to.
class YawSpectrum {
 public:
  static constexpr int kBands = 8;
  static constexpr int kRadiiPerBand = 4;
  static constexpr int kAngles = 360;            ///< over half a turn: the spectrum is even
  static constexpr double kMinFrequency = 0.05;  ///< cycles per metre
  static constexpr double kMaxFrequency = 0.8;
  static constexpr double kCell_m = 0.6;
  static constexpr int kLeastSide = 3;  ///< of which a Hann window, zero at its ends, leaves one

  /// Whether the spectrum of such a grid holds every frequency that is read.
  static bool covers(const BevGrid& grid);

  YawSpectrum(const BevGrid& grid, int channels, const HypothesisAxis& yaw_rad);

  /// scores[k] = -mean((Y_map - Y_bev turned by hypothesis k)^2).
  void score(const CellFeatures& bev, const CellFeatures& map, std::span<double> scores);

  /// The signature of one band of the map that score() read last, [kAngles, lanes()]. Angles are
  /// counter-clockwise from x.
  std::span<const float> map_signature(int band) const { return angles(map_signature_, band); }
  int lanes() const { return spectrum_.lanes(); }

 private:
  struct Pooled {
    CellFeatures bev;
    CellFeatures map;
  };

  void make_taps(const BevGrid& grid);
  void compute_signatures(const CellFeatures& bev, const CellFeatures& map);
  void read_signature(std::span<const float> amplitude, LaneBuffer& signature) const;
  size_t band_begin(int index) const;
  float* band(LaneBuffer& signature, int index) const;
  std::span<const float> angles(const LaneBuffer& signature, int band) const;
  void correlate();

  HypothesisAxis yaw_rad_;
  int channels_;
  int reach_;                     ///< angles by which a hypothesis can shift a signature
  int margin_;                    ///< and what is read beside it
  std::optional<Pooled> pooled_;  ///< for cells finer than kCell_m
  AmplitudeSpectrum spectrum_;
  std::vector<YawTap> taps_;  ///< [band, angle, radius, 4]: bilinear interpolation
  /// [band, margin + angle + margin, lanes]; the margins repeat the other end.
  LaneBuffer bev_signature_;
  LaneBuffer map_signature_;
  std::vector<double> correlations_;  ///< by shift, from -reach_
};

}  // namespace bevloc
