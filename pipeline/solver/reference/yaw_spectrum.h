// Scores yaw by comparing amplitude spectra (paper, III-D, eq. 7 to 10).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/result.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/reference/amplitude_spectrum.h"

namespace bevloc {

/// One sample of the spectrum: its offset in AmplitudeSpectrum::amplitude() and its weight.
struct YawTap {
  int offset = 0;
  float weight = 0.0F;
};

/// The yaw features ("signature") are the amplitude spectrum in polar coordinates of PHYSICAL
/// frequency, because the grid is not square. They are averaged over the radii of each of eight
/// bands and standardised over the angle. Each side has one spectrum. A yaw hypothesis shifts the
/// signature of the BEV features along the angle; rotating the features instead would blur every
/// hypothesis except zero.
///
/// The bands end below the highest frequency of cells of 0.6 m. Features on finer cells are
/// averaged to such cells first. On slightly coarser cells, the highest frequencies alias.
///
/// The constructor allocates all memory. One thread.
class YawSpectrum {
 public:
  static constexpr int kBands = 8;
  static constexpr int kRadiiPerBand = 4;
  static constexpr int kAngles = 360;            ///< number over half a turn; the spectrum is even
  static constexpr double kMinFrequency = 0.05;  ///< cycles per metre
  static constexpr double kMaxFrequency = 0.8;
  static constexpr double kCell_m = 0.6;
  static constexpr int kLeastSide = 3;  ///< a Hann window of 3 samples has one that is not 0

  /// Fails unless the spectrum of the grid contains every frequency that is read.
  static Status check_grid(const BevGrid& grid);

  YawSpectrum(const BevGrid& grid, int channels, const HypothesisAxis& yaw_rad);

  /// Writes scores[k] = -mean((Y_map - Y_bev shifted by yaw hypothesis k)^2).
  void score(const CellFeatures& bev, const CellFeatures& map, std::span<double> scores);

  /// The map's signature in one band, from the last call of score(): [kAngles, lanes()]. Angles are
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
  int reach_;                     ///< most angles by which a hypothesis shifts a signature
  int margin_;                    ///< reach_, and the further angles that dot_group() reads
  std::optional<Pooled> pooled_;  ///< features for grids with cells finer than kCell_m
  AmplitudeSpectrum spectrum_;
  std::vector<YawTap> taps_;  ///< [band, angle, radius, 4]: bilinear interpolation
  /// [band, margin + angle + margin, lanes]; the angle is periodic, so the margins repeat the ends.
  LaneBuffer bev_signature_;
  LaneBuffer map_signature_;
  std::vector<double> correlations_;  ///< correlations by shift, from -reach_ on
};

}  // namespace bevloc
