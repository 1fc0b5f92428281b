// Decoupled neural matching word for word: what this project's own form is measured against.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pipeline/solver/amplitude_spectrum.h"
#include "pipeline/solver/matcher.h"

namespace bevloc {

/// The paper's III-D, eq. 7 to 13, as a plain reading gives it, on the features as they come:
///
/// - Yaw: the vehicle's features are turned by each hypothesis (bilinear, zeros outside),
/// transformed
///   at the grid's own size without a window; the amplitude is read in polar coordinates of its
///   indices (180 angles over half a turn, radii of whole bins up to half the shorter side) and
///   averaged over the radius. P = softmax(-yaw_scale * MSE / mean(Y_M^2)).
/// - x and y: the features turned by the best yaw are shifted by each hypothesis, averaged by GeM
///   (eq. 12, values below 1e-6 raised to it) over the whole of the other axis, and scored by ZNCC
///   over all positions and channels. P = softmax(scale * ZNCC).
/// - Estimates are the best hypotheses (eq. 6 and 10), not means.
///
/// Two things are not the paper's words: the minus in eq. 9, without which the worst yaw wins, and
/// the scales of the softmaxes, without which they are flat; both leave the best hypothesis as it
/// is.
class LiteralMatcher final : public Matcher {
 public:
  /// Whether the transform has the grid's size.
  static bool supports(const BevGrid& grid);

  LiteralMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                 const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
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
