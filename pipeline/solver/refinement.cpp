#include "pipeline/solver/refinement.h"

#include <algorithm>
#include <span>

#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

Se2 correction_of(const Eigen::Vector3d& pose) {
  return {pose.x(), pose.y(), pose.z()};
}

}  // namespace

Refinement::Refinement(const HypothesisGrid& hypotheses, const SolverParameters& parameters)
    : hypotheses_(hypotheses), parameters_(parameters) {
  const int longest =
      std::max({hypotheses.x_m.count(), hypotheses.y_m.count(), hypotheses.yaw_rad.count()});
  scores_.reserve(longest);
  spread_.reserve(longest);
}

void Refinement::refine(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  const PoseScorer scorer(bev.cells, map.cells);
  const ScoreValley valley(map.cells, hypotheses_);
  Eigen::Vector3d pose(result.correction.x_m, result.correction.y_m, result.correction.yaw_rad);
  // y and yaw of the first round were searched at an x that it then found to be wrong.
  pass_through(scorer, valley, pose, result);
  const Passes last = pass_through(scorer, valley, pose, result);

  const auto& [x_m, y_m, yaw_rad] = hypotheses_;
  const FollowedAxis yaw{result.yaw_probability, yaw_rad, last.yaw_at_rad, last.along_yaw.y()};
  spread(yaw, y_m, spread_, result.y_probability);
  spread({result.x_probability, x_m, last.x_at_m, last.along_x.y()}, y_m, spread_,
         result.y_probability);
  spread({result.x_probability, x_m, last.x_at_m, last.along_x.z()}, yaw_rad, spread_,
         result.yaw_probability);
  result.correction = {posterior_mean(result.x_probability, x_m),
                       posterior_mean(result.y_probability, y_m),
                       posterior_mean(result.yaw_probability, yaw_rad)};
}

Refinement::Passes Refinement::pass_through(const PoseScorer& scorer, const ScoreValley& valley,
                                            Eigen::Vector3d& pose, SolverResult& result) {
  Passes passes;
  search(scorer, 1, Eigen::Vector3d::UnitY(), parameters_.refine_y_scale, pose,
         result.y_probability);
  passes.yaw_at_rad = pose.z();
  passes.along_yaw = valley.along_yaw(correction_of(pose));
  search(scorer, 2, passes.along_yaw, parameters_.refine_yaw_scale, pose, result.yaw_probability);
  passes.x_at_m = pose.x();
  passes.along_x = valley.along_x(correction_of(pose));
  search(scorer, 0, passes.along_x, parameters_.refine_x_scale, pose, result.x_probability);
  return passes;
}

void Refinement::search(const PoseScorer& scorer, int axis, const Eigen::Vector3d& direction,
                        double scale, Eigen::Vector3d& pose, std::vector<float>& probability) {
  const HypothesisAxis* axes[] = {&hypotheses_.x_m, &hypotheses_.y_m, &hypotheses_.yaw_rad};
  const Eigen::Vector3d farthest(axes[0]->farthest(), axes[1]->farthest(), axes[2]->farthest());
  scores_.resize(axes[axis]->count());
  for (int i = 0; i < axes[axis]->count(); ++i) {
    const Eigen::Vector3d on_line = pose + (axes[axis]->value(i) - pose(axis)) * direction;
    scores_[i] = scorer.score(correction_of(on_line.cwiseMax(-farthest).cwiseMin(farthest)));
  }
  softmax(scores_, scale, probability);
  pose += (posterior_mean(probability, *axes[axis]) - pose(axis)) * direction;
}

}  // namespace bevloc
