#include "pipeline/solver/reference/full_matcher.h"

#include <span>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/reference/joint_posterior.h"

namespace bevloc {

FullMatcher::FullMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                         const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      x_plan_(hypotheses.x_m, grid.cell_m),
      y_plan_(hypotheses.y_m, grid.cell_m),
      scorer_(grid, channels, hypotheses),
      scores_(hypotheses.count()),
      probability_(hypotheses.count()) {}

void FullMatcher::match(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  scorer_.set_features(bev.cells, map.cells);
  const size_t slice = scores_.size() / hypotheses_.yaw_rad.count();
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    scorer_.score(hypotheses_.yaw_rad.value(k), x_plan_, y_plan_,
                  std::span(scores_).subspan(k * slice, slice));
  }
  softmax(scores_, parameters_.joint_scale, probability_);
  summarise_joint(probability_, hypotheses_, result);
}

}  // namespace bevloc
