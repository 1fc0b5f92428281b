#include "pipeline/solver/decoupled_solver.h"

#include <span>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"

namespace bevloc {

DecoupledSolver::DecoupledSolver(const BevGrid& grid, int channels,
                                 const HypothesisGrid& hypotheses,
                                 const SolverParameters& parameters, Refinement refinement)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      refinement_(refinement),
      bev_(grid, channels, hypotheses),
      map_(grid, channels, hypotheses),
      yaw_spectrum_(grid, channels, hypotheses.yaw_rad),
      axis_matching_(grid, channels, hypotheses),
      x_plan_(hypotheses.x_m, grid.cell_m),
      y_plan_(hypotheses.y_m, grid.cell_m),
      scorer_(grid, channels, hypotheses),
      match_covariance_(grid, channels, hypotheses),
      cell_m_(grid.cell_m),
      standardised_(static_cast<size_t>(channels) * grid.cells()),
      x_scores_(hypotheses.x_m.count()),
      y_scores_(hypotheses.y_m.count()),
      yaw_scores_(hypotheses.yaw_rad.count()) {}

void DecoupledSolver::solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) {
  for (const auto& [view, features] : {std::pair(&bev, &bev_), std::pair(&map, &map_)}) {
    if (!standardise(*view, standardised_)) return set_no_evidence(hypotheses_, result);
    features->assign(standardised_);
  }
  resize_distributions(hypotheses_, result);
  solve_decoupled(result);
  if (refinement_ == Refinement::kOn) refine(result);
  result.covariance = covariance(result);
  result.evidence = Evidence::kGood;
}

void DecoupledSolver::solve_decoupled(SolverResult& result) {
  yaw_spectrum_.score(bev_, map_, yaw_scores_);
  softmax(yaw_scores_, parameters_.yaw_scale, result.yaw_probability);
  result.correction.yaw_rad = posterior_mean(result.yaw_probability, hypotheses_.yaw_rad);

  axis_matching_.set_features(bev_, result.correction.yaw_rad, map_);
  axis_matching_.score_x(x_scores_);
  softmax(x_scores_, parameters_.x_scale, result.x_probability);
  result.correction.x_m = posterior_mean(result.x_probability, hypotheses_.x_m);

  axis_matching_.score_y(y_scores_);
  softmax(y_scores_, parameters_.y_scale, result.y_probability);
  result.correction.y_m = posterior_mean(result.y_probability, hypotheses_.y_m);
}

void DecoupledSolver::refine(SolverResult& result) {
  Se2& correction = result.correction;
  scorer_.set_features(bev_, map_);
  x_fixed_.set_shift(correction.x_m / cell_m_);
  scorer_.score(correction.yaw_rad, x_fixed_, y_plan_, y_scores_);
  softmax(y_scores_, parameters_.joint_scale, result.y_probability);
  correction.y_m = posterior_mean(result.y_probability, hypotheses_.y_m);

  y_fixed_.set_shift(correction.y_m / cell_m_);
  for (int k = 0; k < hypotheses_.yaw_rad.count(); ++k) {
    scorer_.score(hypotheses_.yaw_rad.value(k), x_fixed_, y_fixed_,
                  std::span(yaw_scores_).subspan(k, 1));
  }
  softmax(yaw_scores_, parameters_.joint_scale, result.yaw_probability);
  correction.yaw_rad = posterior_mean(result.yaw_probability, hypotheses_.yaw_rad);

  scorer_.score(correction.yaw_rad, x_plan_, y_fixed_, x_scores_);
  softmax(x_scores_, parameters_.joint_scale, result.x_probability);
  correction.x_m = posterior_mean(result.x_probability, hypotheses_.x_m);
}

Eigen::Matrix3d DecoupledSolver::covariance(const SolverResult& result) {
  const Eigen::Matrix3d vouched = match_covariance_.estimate(bev_, map_, result.correction);
  const Eigen::Vector3d claimed(posterior_variance(result.x_probability, hypotheses_.x_m),
                                posterior_variance(result.y_probability, hypotheses_.y_m),
                                posterior_variance(result.yaw_probability, hypotheses_.yaw_rad));
  const Eigen::Vector3d growth =
      (claimed.cwiseMax(vouched.diagonal()).cwiseQuotient(vouched.diagonal())).cwiseSqrt();
  Eigen::Matrix3d covariance = growth.asDiagonal() * vouched * growth.asDiagonal();
  covariance.diagonal() += least_variance(hypotheses_);
  return covariance;
}

}  // namespace bevloc
