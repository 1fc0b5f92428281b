#include "pipeline/solver/full_solver.h"

#include <span>

#include "pipeline/solver/joint_posterior.h"
#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"

namespace bevloc {

FullSolver::FullSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                       const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      x_plan_(hypotheses.x_m, grid.cell_m),
      y_plan_(hypotheses.y_m, grid.cell_m),
      bev_(grid, channels, hypotheses),
      map_(grid, channels, hypotheses),
      scorer_(grid, channels, hypotheses),
      standardised_(static_cast<size_t>(channels) * grid.cells()),
      scores_(static_cast<size_t>(x_plan_.hypotheses()) * y_plan_.hypotheses() *
              hypotheses.yaw_rad.count()),
      probability_(scores_.size()) {}

void FullSolver::solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) {
  for (const auto& [view, features] : {std::pair(&bev, &bev_), std::pair(&map, &map_)}) {
    if (!standardise(*view, standardised_)) return set_no_evidence(hypotheses_, result);
    features->assign(standardised_);
  }
  scorer_.set_features(bev_, map_);
  const size_t slice = scores_.size() / hypotheses_.yaw_rad.count();
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    scorer_.score(hypotheses_.yaw_rad.value(k), x_plan_, y_plan_,
                  std::span(scores_).subspan(k * slice, slice));
  }
  softmax(scores_, parameters_.joint_scale, probability_);
  resize_distributions(hypotheses_, result);
  summarise_joint(probability_, hypotheses_, result);
}

}  // namespace bevloc
