#include "pipeline/solver/matching_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"

namespace bevloc {
namespace {

// How the two deviations are joined. Found on tuning scenes (docs/solver.md).
constexpr double kClaimedWeight = 0.4;
/// What is hardly seen is as likely anywhere: 1 sigma that covers two thirds of that is more than
/// its deviation.
constexpr double kUnseenGrowth = 0.7;
constexpr double kRefinedFactor = 0.95;
constexpr double kUnrefinedFactor = 1.1;

/// Of two places that are as likely the distribution alone knows.
double claimed_weight(bool claims_more, double rival_peak) {
  return claims_more ? std::lerp(kClaimedWeight, 1.0, std::min(1.0, 2.0 * rival_peak))
                     : kClaimedWeight;
}

/// False where there is nothing to match.
bool take(const FeatureView& features, CellFeatures& cells) {
  if (features.data.size() != static_cast<size_t>(cells.channels()) * cells.grid().cells()) {
    return false;
  }
  cells.assign(features.data);
  return standardise(cells);
}

}  // namespace

MatchingSolver::MatchingSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                               const SolverParameters& parameters, std::unique_ptr<Matcher> matcher,
                               Refine refine)
    : hypotheses_(hypotheses),
      sigma_scale_(parameters.sigma_scale *
                   (refine == Refine::kYes ? kRefinedFactor : kUnrefinedFactor)),
      bev_cells_(grid, channels, hypotheses),
      map_cells_(grid, channels, hypotheses),
      matcher_(std::move(matcher)),
      match_covariance_(grid, channels, hypotheses) {
  if (refine == Refine::kYes) refinement_.emplace(hypotheses, parameters);
}

void MatchingSolver::solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) {
  if (!take(bev, bev_cells_) || !take(map, map_cells_)) {
    return set_no_evidence(hypotheses_, result);
  }
  const MatchSide bev_side{bev.data, bev_cells_};
  const MatchSide map_side{map.data, map_cells_};
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

Eigen::Matrix3d MatchingSolver::covariance(const SolverResult& result) {
  const Eigen::Matrix3d vouched =
      match_covariance_.estimate(bev_cells_, map_cells_, result.correction);
  const Eigen::Vector3d uniform = uniform_variance(hypotheses_).cwiseSqrt();
  const Eigen::Vector3d vouched_sigma = vouched.diagonal().cwiseSqrt();
  const Eigen::Vector3d claimed_sigma = claimed_deviations(result).cwiseMin(uniform);
  Eigen::Vector3d sigma;
  for (int i = 0; i < 3; ++i) {
    const double weight = claimed_weight(claimed_sigma(i) > vouched_sigma(i), result.rival_peak(i));
    const double unseen = std::min(1.0, std::max(claimed_sigma(i), vouched_sigma(i)) / uniform(i));
    sigma(i) = sigma_scale_ * std::pow(claimed_sigma(i), weight) *
               std::pow(vouched_sigma(i), 1.0 - weight) * (1.0 + kUnseenGrowth * unseen * unseen);
  }
  const Eigen::Vector3d growth = sigma.cwiseQuotient(vouched_sigma);
  Eigen::Matrix3d covariance = growth.asDiagonal() * vouched * growth.asDiagonal();
  covariance.diagonal() += least_variance(hypotheses_);
  return covariance;
}

Eigen::Vector3d MatchingSolver::claimed_deviations(const SolverResult& result) const {
  Eigen::Vector3d variance(posterior_variance(result.x_probability, hypotheses_.x_m),
                           posterior_variance(result.y_probability, hypotheses_.y_m),
                           posterior_variance(result.yaw_probability, hypotheses_.yaw_rad));
  return (variance.cwiseMax(0.0) + least_variance(hypotheses_)).cwiseSqrt();
}

}  // namespace bevloc
