// Full neural matching by cross-correlation: the fair measure of what decoupling saves.
#pragma once

#include <vector>

#include "pipeline/solver/matcher.h"
#include "pipeline/solver/shift_correlation.h"
#include "pipeline/solver/shift_energy.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// Every hypothesis, scored as FullMatcher does, from one warp and one cross-correlation per yaw.
/// Exact but for one thing: the vehicle's features are first turned onto whole cells and then read
/// between them, where FullMatcher turns and shifts them in one interpolation. For yaw 0 both are
/// the same.
class FullFftMatcher final : public Matcher {
 public:
  FullFftMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                 const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  void turn(const CellFeatures& bev, double yaw_rad);
  void score(std::span<double> scores) const;
  double correlation(const SplitShift& row, const SplitShift& col) const;

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  BevGrid grid_;
  int channels_;
  ShiftRange shifts_;
  std::vector<SplitShift> row_shifts_;  ///< by hypothesis of x
  std::vector<SplitShift> col_shifts_;  ///< by hypothesis of y
  ShiftCorrelation shift_correlation_;
  ShiftEnergy shift_energy_;
  LaneBuffer frame_;  ///< the turned features, as far around the grid as the shifts reach
  FeatureMoments map_moments_;
  std::vector<double> correlation_;
  std::vector<double> scores_;      ///< [yaw, x, y]
  std::vector<float> probability_;  ///< [yaw, x, y]
};

}  // namespace bevloc
