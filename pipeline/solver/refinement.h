// One more look at a solution, with the full score.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/solver/matcher.h"
#include "pipeline/solver/pose_scorer.h"
#include "pipeline/solver/score_valley.h"

namespace bevloc {

/// Two rounds of true two-dimensional ZNCC (paper, eq. 5) through the estimate so far, each one
/// pass along y, yaw and x, in this order, over the hypotheses of each axis: 11 + 21 + 21. What has
/// been searched follows along the score's valley (ScoreValley): y while yaw is searched, y and yaw
/// while x is. The distributions are the marginals that follow from the last three passes, the
/// estimate their means.
class Refinement {
 public:
  Refinement(const HypothesisGrid& hypotheses, const SolverParameters& parameters);

  void refine(const MatchSide& bev, const MatchSide& map, SolverResult& result);

 private:
  /// Where the passes along yaw and x began, and how the axes before them followed.
  struct Passes {
    double yaw_at_rad = 0.0;
    double x_at_m = 0.0;
    Eigen::Vector3d along_yaw;
    Eigen::Vector3d along_x;
  };

  Passes pass_through(const PoseScorer& scorer, const ScoreValley& valley, Eigen::Vector3d& pose,
                      SolverResult& result);

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
