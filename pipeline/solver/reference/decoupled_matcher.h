// Decoupled matching: yaw, then x and y, each on its own features.
#pragma once

#include <vector>

#include "common/result.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/reference/axis_matching.h"
#include "pipeline/solver/reference/yaw_spectrum.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// The paper's method (III-D, eq. 7 to 14) with this project's changes (docs/solver.md): yaw from
/// one amplitude spectrum per side; then the BEV features are rotated by it, and x and y follow
/// from axis features. That takes 53 hypotheses instead of 4,851. The correction is the mean of the
/// distributions.
class DecoupledMatcher final : public Matcher {
 public:
  DecoupledMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                   const SolverParameters& parameters);

  /// Fails unless the yaw spectrum supports the grid (YawSpectrum::check_grid()).
  static Status check_grid(const BevGrid& grid) { return YawSpectrum::check_grid(grid); }

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  YawSpectrum yaw_spectrum_;
  AxisMatching axis_matching_;
  std::vector<double> x_scores_;
  std::vector<double> y_scores_;
  std::vector<double> yaw_scores_;
};

}  // namespace bevloc
