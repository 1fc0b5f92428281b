// Full neural matching: the reference that every other matcher is measured against.
#pragma once

#include <vector>

#include "pipeline/solver/matcher.h"
#include "pipeline/solver/translation_scorer.h"

namespace bevloc {

/// Every hypothesis of the grid by warp and global zero-padded ZNCC of the standardised features
/// (paper, III-D, eq. 4 and 5): 21 x 11 x 21 = 4,851 by default. Joint posterior =
/// softmax(joint_scale * ZNCC); the distributions are its marginals, the correction its mean.
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
