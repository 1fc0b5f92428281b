// Scores every hypothesis by cross-correlation. It is the baseline for comparisons of speed.
#pragma once

#include <vector>

#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/reference/shift_correlation.h"
#include "pipeline/solver/reference/shift_energy.h"
#include "pipeline/solver/solver_parameters.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// Computes the scores of FullMatcher from one warp and one cross-correlation per yaw. There is one
/// difference: it rotates the BEV features first and then shifts them, with one interpolation each,
/// while FullMatcher does both in one interpolation. For yaw 0 the scores are the same.
class FullFftMatcher final : public Matcher {
 public:
  FullFftMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                 const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  void rotate(const CellFeatures& bev, double yaw_rad);
  void score(std::span<double> scores) const;
  double correlation(const SplitShift& row, const SplitShift& col) const;

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  BevGrid grid_;
  int channels_;
  ShiftRange shifts_;
  std::vector<SplitShift> row_shifts_;  ///< per x hypothesis
  std::vector<SplitShift> col_shifts_;  ///< per y hypothesis
  ShiftCorrelation shift_correlation_;
  ShiftEnergy shift_energy_;
  LaneBuffer frame_;  ///< the rotated features, with a border as wide as the largest shift
  FeatureMoments map_moments_;
  std::vector<double> correlation_;
  std::vector<double> scores_;      ///< [yaw, x, y]
  std::vector<float> probability_;  ///< [yaw, x, y]
};

}  // namespace bevloc
