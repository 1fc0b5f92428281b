// One more look at a solution, with the full score.
#pragma once

#include <vector>

#include "pipeline/solver/matcher.h"
#include "pipeline/solver/translation_scorer.h"

namespace bevloc {

/// One coordinate pass of true two-dimensional ZNCC (paper, eq. 5) through the estimate so far, in
/// the order y, yaw, x, over the hypotheses of each axis: 11 + 21 + 21. Its distributions replace
/// the first ones, its means the estimate.
class Refinement {
 public:
  Refinement(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
             const SolverParameters& parameters);

  void refine(const MatchSide& bev, const MatchSide& map, SolverResult& result);

 private:
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  double cell_m_;
  ShiftPlan x_plan_;
  ShiftPlan y_plan_;
  ShiftPlan x_fixed_;
  ShiftPlan y_fixed_;
  TranslationScorer scorer_;
  std::vector<double> x_scores_;
  std::vector<double> y_scores_;
  std::vector<double> yaw_scores_;
};

}  // namespace bevloc
