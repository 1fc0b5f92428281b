#include "pipeline/solver/refinement.h"

#include <algorithm>

#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

/// A round skips hypotheses that are less likely than this share of the most likely one.
constexpr float kLeastLikely = 1e-2F;
/// Factor on the scales of the coarse rounds: the score of fewer cells is noisier.
constexpr double kCoarseScale = 0.5;

Se2 correction_of(const Eigen::Vector3d& pose) {
  return {pose.x(), pose.y(), pose.z()};
}

}  // namespace

Refinement::Refinement(const CellFeatures& map, const HypothesisGrid& hypotheses,
                       const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      coarse_cells_(map, kEveryTenthCell),
      fine_cells_(map, kEverySecondCell) {
  const int longest =
      std::max({hypotheses.x_m.count(), hypotheses.y_m.count(), hypotheses.yaw_rad.count()});
  scored_.reserve(longest);
  scores_.reserve(longest);
  scratch_.reserve(longest);
}

void Refinement::refine(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  const ScoreValley valley(map.cells, hypotheses_);
  Eigen::Vector3d pose(result.correction.x_m, result.correction.y_m, result.correction.yaw_rad);
  const PoseScorer coarse(bev.cells, map.cells, coarse_cells_);
  const PoseScorer fine(bev.cells, map.cells, fine_cells_);
  // The first round searches y and yaw at an x that it then corrects, so a second one follows.
  search_all_axes({coarse, kCoarseScale, 0.0F}, valley, pose, result);
  search_all_axes({coarse, kCoarseScale, kLeastLikely}, valley, pose, result);
  search_all_axes({fine, 1.0, kLeastLikely}, valley, pose, result);
  result.correction = mean_correction(result, hypotheses_);
}

void Refinement::search_all_axes(const Round& round, const ScoreValley& valley,
                                 Eigen::Vector3d& pose, SolverResult& result) {
  const auto& [x_m, y_m, yaw_rad] = hypotheses_;
  std::vector<float>& x = result.x_probability;
  std::vector<float>& y = result.y_probability;
  std::vector<float>& yaw = result.yaw_probability;
  search(round, 1, Eigen::Vector3d::UnitY(), pose, y);
  const double yaw_before_rad = pose.z();
  const Eigen::Vector3d along_yaw = valley.along_yaw(correction_of(pose));
  search(round, 2, along_yaw, pose, yaw);
  const double x_before_m = pose.x();
  const Eigen::Vector3d along_x = valley.along_x(correction_of(pose));
  search(round, 0, along_x, pose, x);

  // The searches of yaw and x moved y and yaw along: add the uncertainty of the searched axis.
  convolve({yaw, yaw_rad, yaw_before_rad, along_yaw.y()}, y_m, scratch_, y);
  convolve({x, x_m, x_before_m, along_x.y()}, y_m, scratch_, y);
  convolve({x, x_m, x_before_m, along_x.z()}, yaw_rad, scratch_, yaw);
}

void Refinement::search(const Round& round, int axis, const Eigen::Vector3d& direction,
                        Eigen::Vector3d& pose, std::vector<float>& probability) {
  const HypothesisAxis* axes[] = {&hypotheses_.x_m, &hypotheses_.y_m, &hypotheses_.yaw_rad};
  const double scales[] = {parameters_.refine_x_scale, parameters_.refine_y_scale,
                           parameters_.refine_yaw_scale};
  const Eigen::Vector3d farthest(axes[0]->farthest(), axes[1]->farthest(), axes[2]->farthest());
  const float least = round.least * *std::ranges::max_element(probability);
  scored_.clear();
  scores_.clear();
  for (int i = 0; i < axes[axis]->count(); ++i) {
    if (probability[i] < least) continue;
    const Eigen::Vector3d on_line = pose + (axes[axis]->value(i) - pose(axis)) * direction;
    const Eigen::Vector3d inside = on_line.cwiseMax(-farthest).cwiseMin(farthest);
    scored_.push_back(i);
    scores_.push_back(round.scorer.score(correction_of(inside)));
  }
  redistribute(scored_, scores_, round.scale * scales[axis], probability);
  pose += (posterior_mean(probability, *axes[axis]) - pose(axis)) * direction;
}

}  // namespace bevloc
