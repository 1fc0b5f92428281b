#include "pipeline/solver/matching_solver.h"

#include <utility>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"

namespace bevloc {

MatchingSolver::MatchingSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                               const SolverParameters& parameters, std::unique_ptr<Matcher> matcher,
                               Refine refine)
    : hypotheses_(hypotheses),
      bev_standardised_(static_cast<size_t>(channels) * grid.cells()),
      map_standardised_(bev_standardised_.size()),
      bev_cells_(grid, channels, hypotheses),
      map_cells_(grid, channels, hypotheses),
      matcher_(std::move(matcher)),
      match_covariance_(grid, channels, hypotheses) {
  if (refine == Refine::kYes) refinement_.emplace(grid, channels, hypotheses, parameters);
}

void MatchingSolver::solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) {
  if (!standardise(bev, bev_standardised_) || !standardise(map, map_standardised_)) {
    return set_no_evidence(hypotheses_, result);
  }
  bev_cells_.assign(bev_standardised_);
  map_cells_.assign(map_standardised_);
  const MatchSide bev_side{bev.data, bev_standardised_, bev_cells_};
  const MatchSide map_side{map.data, map_standardised_, map_cells_};
  resize_distributions(hypotheses_, result);
  matcher_->match(bev_side, map_side, result);
  if (refinement_) refinement_->refine(bev_side, map_side, result);
  result.parabola = {parabola_top(result.x_probability, hypotheses_.x_m),
                     parabola_top(result.y_probability, hypotheses_.y_m),
                     parabola_top(result.yaw_probability, hypotheses_.yaw_rad)};
  result.rival_peak = {rival_peak(result.x_probability), rival_peak(result.y_probability),
                       rival_peak(result.yaw_probability)};
  result.covariance = covariance(result);
  result.evidence_share = Eigen::Vector3d::Ones() -
                          result.covariance.diagonal().cwiseQuotient(uniform_variance(hypotheses_));
  result.evidence = Evidence::kGood;
}

/// The larger, per axis, of the distribution's variance and of what MatchCovariance can vouch for,
/// with the latter's correlations.
Eigen::Matrix3d MatchingSolver::covariance(const SolverResult& result) {
  const Eigen::Matrix3d vouched =
      match_covariance_.estimate(bev_cells_, map_cells_, result.correction);
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
