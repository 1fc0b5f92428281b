// One more look at a solution, with the full score.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/solver/matcher.h"
#include "pipeline/solver/pose_scorer.h"
#include "pipeline/solver/score_valley.h"

namespace bevloc {

/// Rounds of true two-dimensional ZNCC (paper, eq. 5) through the estimate so far, each one pass
/// along y, yaw and x, in this order, over hypotheses of each axis. What has been searched follows
/// along the score's valley (ScoreValley): y while yaw is searched, y and yaw while x is. A round's
/// distributions are the marginals that follow from its three passes; the estimate are the means of
/// the last one's.
///
/// Two coarse rounds see a tenth of the cells: they only say where the last one begins, which sees
/// every second cell, and what it need not look at. The first scores all hypotheses, the next those
/// that the one before leaves likely; the others keep their probability. Neighbouring cells see
/// much the same: on all of them, the estimates are no better (docs/solver.md).
class Refinement {
 public:
  Refinement(const HypothesisGrid& hypotheses, const SolverParameters& parameters);

  /// Begins at the correction of `result`.
  void refine(const MatchSide& bev, const MatchSide& map, SolverResult& result);

 private:
  /// One pass along each axis, and how it scores.
  struct Round {
    const PoseScorer& scorer;
    double scale;  ///< of what the parameters say
    float least;   ///< of the greatest probability so far: with less, a hypothesis is not scored
  };

  void pass_through(const Round& round, const ScoreValley& valley, Eigen::Vector3d& pose,
                    SolverResult& result);

  /// Scores hypotheses of an axis (0 x, 1 y, 2 yaw) along a line through `pose`, which ends at the
  /// mean of `probability`. `direction` is 1 along the axis itself.
  void search(const Round& round, int axis, const Eigen::Vector3d& direction, Eigen::Vector3d& pose,
              std::vector<float>& probability);

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  std::vector<int> scored_;  ///< hypotheses of the axis that is searched
  std::vector<double> scores_;
  std::vector<float> spread_;
};

}  // namespace bevloc
