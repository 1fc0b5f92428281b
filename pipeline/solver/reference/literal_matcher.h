// The paper's decoupled matching, read literally; a baseline for DecoupledMatcher.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/result.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/reference/amplitude_spectrum.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// Section III-D of the paper, eq. 7 to 13, read literally, on features that are not standardised:
///
/// - Yaw: each hypothesis rotates the BEV features (bilinear, zero outside). The rotated copy is
///   transformed at the size of the grid, without a window. Its amplitudes are read in polar
///   coordinates of their indices (180 angles over half a turn, whole radii up to half the shorter
///   side) and averaged over the radius. P = softmax(-yaw_scale * MSE / mean(Y_M^2)).
/// - x and y: each hypothesis shifts the features rotated by the best yaw. GeM (eq. 12; values
///   below 1e-6 are raised to it) averages over the whole of the other axis. The score is the ZNCC
///   over all positions and channels. P = softmax(scale * ZNCC).
/// - The correction consists of the best hypotheses (eq. 6 and 10), not of means.
///
/// Two things are not in the paper: the minus sign in eq. 9, without which the worst yaw would win,
/// and the scales of the softmaxes, without which the distributions would be flat. Neither scale
/// changes the best hypothesis.
class LiteralMatcher final : public Matcher {
 public:
  /// Fails unless the Fourier transform supports the size of the grid.
  static Status check_grid(const BevGrid& grid);

  LiteralMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                 const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  /// Where one polar sample reads the spectrum: bilinearly, from this frequency on.
  struct PolarTap {
    int row;
    int col;
    float row_fraction;
    float col_fraction;
  };

  void move(const Se2& correction, CellFeatures& moved) const;
  void yaw_features(std::span<const float> amplitude, std::vector<float>& yaw) const;
  void axis_features(const CellFeatures& features, std::vector<float>& x,
                     std::vector<float>& y) const;
  double solve_yaw(SolverResult& result);
  double yaw_score(size_t side);
  void solve_axis(const HypothesisAxis& axis, double yaw_rad, bool along_x, double scale,
                  std::vector<float>& probability);

  BevGrid grid_;
  int channels_;
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  CellFeatures bev_;
  CellFeatures map_;
  std::array<CellFeatures, 2> moved_;
  AmplitudeSpectrum spectrum_;
  std::vector<PolarTap> taps_;  ///< [angle, radius]
  std::vector<float> scaled_;
  std::vector<float> map_yaw_;  ///< [angle, channel]
  std::vector<float> bev_yaw_;
  std::vector<float> map_x_;  ///< [row, channel]
  std::vector<float> map_y_;  ///< [col, channel]
  std::vector<float> bev_x_;
  std::vector<float> bev_y_;
  std::vector<double> scores_;
};

}  // namespace bevloc
