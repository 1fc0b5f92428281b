// Full neural matching: the reference that every other solver is measured against.
#pragma once

#include <vector>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"
#include "pipeline/solver/translation_scorer.h"

namespace bevloc {

/// Every hypothesis of the grid by warp and global zero-padded ZNCC of the standardised features
/// (paper, III-D, eq. 4 and 5): 21 x 11 x 21 = 4,851 by default. Joint posterior =
/// softmax(joint_scale * ZNCC); the distributions are its marginals, the correction its mean, the
/// covariance its own, plus what the steps of the grid cannot resolve.
class FullSolver final : public Solver {
 public:
  FullSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
             const SolverParameters& parameters);

  void solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) override;

 private:
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  ShiftPlan x_plan_;
  ShiftPlan y_plan_;
  CellFeatures bev_;
  CellFeatures map_;
  TranslationScorer scorer_;
  std::vector<float> standardised_;
  std::vector<double> scores_;      ///< [yaw, x, y]
  std::vector<float> probability_;  ///< [yaw, x, y]
};

}  // namespace bevloc
