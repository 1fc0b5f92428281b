#include "tests/fuzz/solver_invariants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>

#include <Eigen/Cholesky>

#include "pipeline/solver/posterior.h"

namespace bevloc::fuzz {
namespace {

/// The tolerance for sums of float probabilities, and for values at the end of an axis.
constexpr double kSumTolerance = 1e-4;

struct AxisResult {
  std::string_view name;
  const HypothesisAxis& axis;
  const std::vector<float>& probability;
  double correction;
  double parabola;
};

std::array<AxisResult, 3> axes_of(const SolverResult& r, const HypothesisGrid& h) {
  return {{{"x", h.x_m, r.x_probability, r.correction.x_m, r.parabola.x_m},
           {"y", h.y_m, r.y_probability, r.correction.y_m, r.parabola.y_m},
           {"yaw", h.yaw_rad, r.yaw_probability, r.correction.yaw_rad, r.parabola.yaw_rad}}};
}

Status check_axis(const AxisResult& a) {
  if (static_cast<int>(a.probability.size()) != a.axis.count()) {
    return fail("{}: found {} probabilities, wanted {}", a.name, a.probability.size(),
                a.axis.count());
  }
  for (float p : a.probability) {
    if (!(p >= 0.0F && p <= 1.0F + kSumTolerance))
      return fail("{}: found probability {}, wanted 0 to 1", a.name, p);
  }
  const double sum = std::accumulate(a.probability.begin(), a.probability.end(), 0.0);
  if (!(std::abs(sum - 1.0) <= kSumTolerance))
    return fail("{}: found probabilities with sum {}, wanted 1", a.name, sum);
  const double reach = a.axis.farthest() * (1.0 + kSumTolerance);
  for (double value : {a.correction, a.parabola}) {
    if (!(std::abs(value) <= reach)) {
      return fail("{}: found {}, wanted at most the farthest hypothesis, {}", a.name, value,
                  a.axis.farthest());
    }
  }
  return {};
}

Status check_covariance(const Eigen::Matrix3d& covariance, const HypothesisGrid& hypotheses) {
  if (!covariance.allFinite()) return fail("covariance: found a value that is not finite");
  if (!covariance.isApprox(covariance.transpose(), 1e-12))
    return fail("covariance: found an asymmetric matrix");
  const Eigen::Vector3d least = least_variance(hypotheses);
  for (int i = 0; i < 3; ++i) {
    if (!(covariance(i, i) >= least(i) * (1.0 - 1e-9))) {
      return fail("variance {}: found {}, wanted at least {}", i, covariance(i, i), least(i));
    }
  }
  // The axes have different units, so the correlation matrix is tested.
  const Eigen::Vector3d unit = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d correlation = unit.asDiagonal() * covariance * unit.asDiagonal();
  if (correlation.llt().info() != Eigen::Success)
    return fail("covariance: found a matrix that is not positive definite");
  return {};
}

Status check_no_evidence(const SolverResult& result, const HypothesisGrid& hypotheses) {
  for (const AxisResult& a : axes_of(result, hypotheses)) {
    if (a.correction != 0.0 || a.parabola != 0.0)
      return fail("{}: found a correction without evidence", a.name);
    if (std::ranges::min(a.probability) != std::ranges::max(a.probability)) {
      return fail("{}: found a distribution that is not uniform without evidence", a.name);
    }
  }
  if (!result.rival_peak.isZero(0.0) || !result.evidence_share.isZero(0.0) || result.score != 0.0 ||
      !result.axis_score.isZero(0.0) || !result.edge_mass.isZero(0.0)) {
    return fail("found rival peaks, evidence shares, scores or edge masses without evidence");
  }
  const Eigen::Matrix3d uniform = uniform_variance(hypotheses).asDiagonal();
  if (result.covariance != uniform)
    return fail("covariance: found other than that of uniform hypotheses without evidence");
  return {};
}

}  // namespace

Status check_result(const SolverResult& result, const HypothesisGrid& hypotheses,
                    double score_scale) {
  for (const AxisResult& axis : axes_of(result, hypotheses)) {
    if (auto status = check_axis(axis); !status) return status;
  }
  if (auto status = check_covariance(result.covariance, hypotheses); !status) return status;
  for (int i = 0; i < 3; ++i) {
    if (!(result.rival_peak(i) >= 0.0 && result.rival_peak(i) <= 1.0)) {
      return fail("rival peak {}: found {}, wanted 0 to 1", i, result.rival_peak(i));
    }
    if (!(result.axis_score(i) >= 0.0 && result.axis_score(i) <= 1.0)) {
      return fail("axis score {}: found {}, wanted 0 to 1", i, result.axis_score(i));
    }
    if (!(result.edge_mass(i) >= 0.0 && result.edge_mass(i) <= 1.0 + kSumTolerance)) {
      return fail("edge mass {}: found {}, wanted 0 to 1", i, result.edge_mass(i));
    }
    if (!(std::isfinite(result.evidence_share(i)) && result.evidence_share(i) <= 1.0)) {
      return fail("evidence share {}: found {}, wanted at most 1", i, result.evidence_share(i));
    }
  }
  if (!(result.score >= 0.0 && result.score <= score_scale)) {
    return fail("score: found {}, wanted 0 to {}", result.score, score_scale);
  }
  return result.evidence == Evidence::kNone ? check_no_evidence(result, hypotheses) : Status{};
}

}  // namespace bevloc::fuzz
