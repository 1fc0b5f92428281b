// One more look at a solution, with the full score.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/solver/matcher.h"
#include "pipeline/solver/pose_scorer.h"

namespace bevloc {

/// One coordinate pass of true two-dimensional ZNCC (paper, eq. 5) through the estimate so far, in
/// the order y, yaw, x, over the hypotheses of each axis: 11 + 21 + 21. What has been searched
/// follows along the score's valley (ScoreValley): y while yaw is searched, y and yaw while x is.
/// The distributions are the marginals that follow from the three passes, the estimate their means.
class Refinement {
 public:
  Refinement(const HypothesisGrid& hypotheses, const SolverParameters& parameters);

  void refine(const MatchSide& bev, const MatchSide& map, SolverResult& result);

 private:
  /// Scores the hypotheses of an axis (0 x, 1 y, 2 yaw) along a line through `pose`, which ends at
  /// the mean of `probability`. `direction` is 1 along the axis itself.
  void search(const PoseScorer& scorer, int axis, const Eigen::Vector3d& direction, double scale,
              Eigen::Vector3d& pose, std::vector<float>& probability);

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  std::vector<double> scores_;
  std::vector<float> spread_;
};

}  // namespace bevloc
