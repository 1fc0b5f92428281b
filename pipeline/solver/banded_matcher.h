// Axis matching band by band: the cheapest start, without a transform and without turning anything.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cubic.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {

/// The standardised features are averaged over 10 bands across x (each has a lateral profile) and
/// over 5 bands across y (each has a longitudinal profile); each channel's profiles are
/// standardised over all bands. c_b(t) and d_b(t) are the correlations of one band's profiles at
/// shift t along y and x, zeros outside, read between whole cells by cubic convolution. A turn by a
/// moves a band at x_b by a x_b along y, and one at y_b by -a y_b along x, so that
///
///   lateral(a, y) = mean over b of c_b(y + a x_b),  longitudinal(a, x) = mean of d_b(x - a y_b),
///   P(a, x, y) ~ exp(banded_y_scale * lateral + banded_x_scale * longitudinal),
///
/// whose marginals are exact at the cost of two small tables: linear in the number of hypotheses of
/// each axis. The correction is their means. Not in the paper.
class BandedMatcher final : public Matcher {
 public:
  BandedMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  /// Profiles of all bands that run along one axis.
  struct Bands {
    std::vector<double> lever_m;  ///< of each band: metres that it moves along the axis per radian
    int length = 0;               ///< cells of a profile
    int reach = 0;                ///< whole shifts -reach ... +reach are correlated
    LaneBuffer bev;               ///< [band, reach + length + reach, lanes], zeros outside
    LaneBuffer map;               ///< [band, length, lanes]
    std::vector<CubicTaps> taps;  ///< where a hypothesis reads the correlation of each band: [yaw,
                                  ///< hypothesis, band]
    std::vector<double> correlation;  ///< [band, shift]
    std::vector<double> scores;       ///< [yaw, hypothesis], then probabilities given the yaw
  };

  void make_profiles(int length, const HypothesisAxis& axis, Bands& bands) const;
  void average(const CellFeatures& features, int lateral_reach, int longitudinal_reach,
               LaneBuffer& lateral, LaneBuffer& longitudinal) const;
  void correlate(Bands& bands) const;
  static void score(Bands& bands);
  static void marginalise(const Bands& bands, std::span<const float> yaw_probability,
                          std::span<float> probability);

  BevGrid grid_;
  int channels_;
  int lanes_;
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  Bands lateral_;       ///< bands across x, profiles along y
  Bands longitudinal_;  ///< bands across y, profiles along x
  std::vector<double> yaw_scores_;
};

}  // namespace bevloc
