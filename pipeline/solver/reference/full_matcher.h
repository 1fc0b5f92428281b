// Scores every hypothesis by warping. It is the reference for accuracy.
#pragma once

#include <vector>

#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/reference/translation_scorer.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// Warps the standardised BEV features by every hypothesis and computes the ZNCC over the whole
/// grid, zero-padded (paper, III-D, eq. 4 and 5). The default grid has 21 x 11 x 21 = 4,851
/// hypotheses. P = softmax(joint_scale * ZNCC). The distributions are the marginals of P, and the
/// correction is its mean.
class FullMatcher final : public Matcher {
 public:
  FullMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
              const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  ShiftPlan x_plan_;
  ShiftPlan y_plan_;
  TranslationScorer scorer_;
  std::vector<double> scores_;      ///< [yaw, x, y]
  std::vector<float> probability_;  ///< [yaw, x, y]
};

}  // namespace bevloc
