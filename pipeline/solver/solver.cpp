#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "pipeline/solver/match_score.h"
#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"

namespace bevloc {
namespace {

// These values combine the two standard deviations. They were found on tuning scenes
// (docs/solver.md).
/// Weight of the distribution's sigma in the geometric mean.
constexpr double kDistributionWeight = 0.4;
/// Along an unobservable axis the error is uniform, and an interval that covers 2/3 is wider than
/// one standard deviation, so sigma is inflated.
constexpr double kUnobservableGrowth = 0.7;
constexpr double kRefinedFactor = 0.95;
constexpr double kUnrefinedFactor = 1.1;

/// With two equally likely peaks, only the distribution's sigma counts: MatchCovariance sees the
/// gradients at one of them and does not know the other.
double distribution_weight(bool distribution_is_wider, double rival_peak) {
  return distribution_is_wider
             ? std::lerp(kDistributionWeight, 1.0, std::min(1.0, 2.0 * rival_peak))
             : kDistributionWeight;
}

/// Copies the features into `cells` and standardises them. Returns false if there is nothing to
/// match.
bool load(const FeatureView& features, CellFeatures& cells) {
  if (features.data.size() != static_cast<size_t>(cells.channels()) * cells.grid().cells()) {
    return false;
  }
  cells.assign(features.data);
  return standardise(cells);
}

}  // namespace

Solver::Solver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
               const SolverParameters& parameters, std::unique_ptr<Matcher> matcher, Refine refine)
    : hypotheses_(hypotheses),
      sigma_scale_(parameters.sigma_scale *
                   (refine == Refine::kYes ? kRefinedFactor : kUnrefinedFactor)),
      score_scale_(parameters.score_scale),
      bev_cells_(grid, channels, hypotheses),
      map_cells_(grid, channels, hypotheses),
      matcher_(std::move(matcher)),
      match_covariance_(grid, channels, hypotheses) {
  if (refine == Refine::kYes) refinement_.emplace(map_cells_, hypotheses, parameters);
}

void Solver::solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) {
  if (!load(bev, bev_cells_) || !load(map, map_cells_)) {
    return set_no_evidence(hypotheses_, result);
  }
  const MatchSide bev_side{bev.data, bev_cells_};
  const MatchSide map_side{map.data, map_cells_};
  resize_distributions(hypotheses_, result);
  matcher_->match(bev_side, map_side, result);
  if (refinement_) refinement_->refine(bev_side, map_side, result);
  result.parabola = {parabola_vertex(result.x_probability, hypotheses_.x_m),
                     parabola_vertex(result.y_probability, hypotheses_.y_m),
                     parabola_vertex(result.yaw_probability, hypotheses_.yaw_rad)};
  result.rival_peak = {rival_peak(result.x_probability), rival_peak(result.y_probability),
                       rival_peak(result.yaw_probability)};
  result.edge_mass = {edge_mass(result.x_probability), edge_mass(result.y_probability),
                      edge_mass(result.yaw_probability)};
  result.covariance = covariance(result);
  const MatchScore score = score_match(map_cells_, match_covariance_.moved(), result.correction,
                                       match_covariance_.border());
  result.score = score_scale_ * score.overlap;
  result.axis_score = score.axis;
  result.evidence_share = Eigen::Vector3d::Ones() -
                          result.covariance.diagonal().cwiseQuotient(uniform_variance(hypotheses_));
  result.evidence = Evidence::kGood;
}

Eigen::Matrix3d Solver::covariance(const SolverResult& result) {
  const Eigen::Matrix3d match =
      match_covariance_.estimate(bev_cells_, map_cells_, result.correction);
  const Eigen::Vector3d uniform = uniform_variance(hypotheses_).cwiseSqrt();
  const Eigen::Vector3d match_sigma = match.diagonal().cwiseSqrt();
  const Eigen::Vector3d distribution_sigma = distribution_sigmas(result).cwiseMin(uniform);
  Eigen::Vector3d sigma;
  for (int i = 0; i < 3; ++i) {
    const double weight =
        distribution_weight(distribution_sigma(i) > match_sigma(i), result.rival_peak(i));
    const double unobservable =
        std::min(1.0, std::max(distribution_sigma(i), match_sigma(i)) / uniform(i));
    sigma(i) = sigma_scale_ * std::pow(distribution_sigma(i), weight) *
               std::pow(match_sigma(i), 1.0 - weight) *
               (1.0 + kUnobservableGrowth * unobservable * unobservable);
  }
  const Eigen::Vector3d growth = sigma.cwiseQuotient(match_sigma);
  Eigen::Matrix3d covariance = growth.asDiagonal() * match * growth.asDiagonal();
  covariance.diagonal() += least_variance(hypotheses_);
  return covariance;
}

Eigen::Vector3d Solver::distribution_sigmas(const SolverResult& result) const {
  Eigen::Vector3d variance(posterior_variance(result.x_probability, hypotheses_.x_m),
                           posterior_variance(result.y_probability, hypotheses_.y_m),
                           posterior_variance(result.yaw_probability, hypotheses_.yaw_rad));
  return (variance.cwiseMax(0.0) + least_variance(hypotheses_)).cwiseSqrt();
}

}  // namespace bevloc
