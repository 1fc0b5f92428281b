// Axis matching band by band: the cheapest matcher, without Fourier transform or rotation.
#pragma once

#include <span>
#include <vector>

#include "pipeline/solver/cubic.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/shift_range.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// The standardised features are averaged over 10 bands across x, which leaves a lateral profile
/// per band, and over 5 bands across y, which leaves a longitudinal profile per band. The profiles
/// of each channel are standardised over all bands. c_b(t) and d_b(t) are the correlations of the
/// profiles of band b at shift t along y and along x. Profiles are zero outside the grid, and the
/// correlations are read between whole cells by cubic convolution. A rotation by a moves a band at
/// x_b by a x_b along y, and a band at y_b by -a y_b along x. Therefore
///
///   lateral(a, y) = mean over b of c_b(y + a x_b),
///   longitudinal(a, x) = mean over b of d_b(x - a y_b),
///   P(a, x, y) ~ exp(banded_y_scale * lateral + banded_x_scale * longitudinal).
///
/// Given a, x and y are independent, so the marginals are exact and need only two small tables. The
/// cost is linear in the number of hypotheses of each axis. The correction is the mean of the
/// marginals. This matcher is not in the paper.
class BandedMatcher final : public Matcher {
 public:
  BandedMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  /// The profiles of all bands that run along one axis, and their correlations.
  struct Bands {
    std::vector<double> lever_m;      ///< per band: metres that it moves along the axis per radian
    int length = 0;                   ///< cells of a profile
    int reach = 0;                    ///< whole shifts -reach ... +reach are correlated
    LaneBuffer bev;                   ///< [band, reach + length + reach, lanes], zero at both ends
    LaneBuffer map;                   ///< [band, length, lanes]
    std::vector<CubicTaps> taps;      ///< [yaw, hypothesis, band]: where a hypothesis reads the
                                      ///< correlation of a band
    std::vector<double> correlation;  ///< [band, shift]
    std::vector<double> scores;       ///< [yaw, hypothesis]; later P(hypothesis | yaw)
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
