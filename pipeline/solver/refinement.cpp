#include "pipeline/solver/refinement.h"

#include <span>

#include "pipeline/solver/posterior.h"

namespace bevloc {

Refinement::Refinement(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                       const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      cell_m_(grid.cell_m),
      x_plan_(hypotheses.x_m, grid.cell_m),
      y_plan_(hypotheses.y_m, grid.cell_m),
      scorer_(grid, channels, hypotheses),
      x_scores_(hypotheses.x_m.count()),
      y_scores_(hypotheses.y_m.count()),
      yaw_scores_(hypotheses.yaw_rad.count()) {}

void Refinement::refine(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  Se2& correction = result.correction;
  scorer_.set_features(bev.cells, map.cells);
  x_fixed_.set_shift(correction.x_m / cell_m_);
  scorer_.score(correction.yaw_rad, x_fixed_, y_plan_, y_scores_);
  softmax(y_scores_, parameters_.refine_y_scale, result.y_probability);
  correction.y_m = posterior_mean(result.y_probability, hypotheses_.y_m);

  y_fixed_.set_shift(correction.y_m / cell_m_);
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    scorer_.score(hypotheses_.yaw_rad.value(k), x_fixed_, y_fixed_,
                  std::span(yaw_scores_).subspan(k, 1));
  }
  softmax(yaw_scores_, parameters_.refine_yaw_scale, result.yaw_probability);
  correction.yaw_rad = posterior_mean(result.yaw_probability, hypotheses_.yaw_rad);

  scorer_.score(correction.yaw_rad, x_plan_, y_fixed_, x_scores_);
  softmax(x_scores_, parameters_.refine_x_scale, result.x_probability);
  correction.x_m = posterior_mean(result.x_probability, hypotheses_.x_m);
}

}  // namespace bevloc
