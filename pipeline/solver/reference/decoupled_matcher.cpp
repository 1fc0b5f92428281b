#include "pipeline/solver/reference/decoupled_matcher.h"

#include "pipeline/solver/posterior.h"

namespace bevloc {

DecoupledMatcher::DecoupledMatcher(const BevGrid& grid, int channels,
                                   const HypothesisGrid& hypotheses,
                                   const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      yaw_spectrum_(grid, channels, hypotheses.yaw_rad),
      axis_matching_(grid, channels, hypotheses),
      x_scores_(hypotheses.x_m.count()),
      y_scores_(hypotheses.y_m.count()),
      yaw_scores_(hypotheses.yaw_rad.count()) {}

void DecoupledMatcher::match(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  yaw_spectrum_.score(bev.cells, map.cells, yaw_scores_);
  softmax(yaw_scores_, parameters_.yaw_scale, result.yaw_probability);
  result.correction.yaw_rad = posterior_mean(result.yaw_probability, hypotheses_.yaw_rad);

  axis_matching_.set_features(bev.cells, result.correction.yaw_rad, map.cells);
  axis_matching_.score_x(x_scores_);
  softmax(x_scores_, parameters_.x_scale, result.x_probability);
  result.correction.x_m = posterior_mean(result.x_probability, hypotheses_.x_m);

  axis_matching_.score_y(y_scores_);
  softmax(y_scores_, parameters_.y_scale, result.y_probability);
  result.correction.y_m = posterior_mean(result.y_probability, hypotheses_.y_m);
}

}  // namespace bevloc
