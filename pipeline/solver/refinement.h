// Scores again around the matcher's solution, with the full two-dimensional ZNCC.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/pose_scorer.h"
#include "pipeline/solver/score_valley.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// Runs three rounds of ZNCC (paper, eq. 5) through the current estimate. Each round searches the
/// hypotheses of y, then yaw, then x. The axes that were already searched follow along the score's
/// valley (ScoreValley): y follows yaw, and y and yaw follow x. The distributions of a round are
/// the marginals of its three searches. The correction is the mean of the last round's.
///
/// The first two rounds are coarse: they use every tenth cell. They find where the last round
/// starts and which hypotheses it can skip. The last round uses every second cell; all cells give
/// no smaller errors, because neighbouring cells carry similar information (docs/solver.md). The
/// first round scores all hypotheses. Each later round scores only those that the round before left
/// likely; the others keep their probability.
class Refinement {
 public:
  /// `map` says where the cells of the map lie in memory.
  Refinement(const CellFeatures& map, const HypothesisGrid& hypotheses,
             const SolverParameters& parameters);

  /// Starts at `result.correction` and overwrites the correction and the distributions.
  void refine(const MatchSide& bev, const MatchSide& map, SolverResult& result);

 private:
  /// How one round scores.
  struct Round {
    const PoseScorer& scorer;
    double scale;  ///< factor on the learned scales
    float least;   ///< hypotheses below this share of the highest probability are not scored
  };

  void search_all_axes(const Round& round, const ScoreValley& valley, Eigen::Vector3d& pose,
                       SolverResult& result);

  /// Scores the hypotheses of one axis (0: x, 1: y, 2: yaw) along a line through `pose`, updates
  /// `probability`, and moves `pose` along the line to the mean. `direction` is the line's
  /// direction; its component along the axis is 1.
  void search(const Round& round, int axis, const Eigen::Vector3d& direction, Eigen::Vector3d& pose,
              std::vector<float>& probability);

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  LatticeCells coarse_cells_;
  LatticeCells fine_cells_;
  std::vector<int> scored_;  ///< indices of the hypotheses that search() scores
  std::vector<double> scores_;
  std::vector<float> scratch_;
};

}  // namespace bevloc
