#include "evaluation/solver/solver_score.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "evaluation/quantile.h"
#include "pipeline/tracker/measurements.h"

namespace bevloc::evaluation {
namespace {

/// Keeps the mean finite if a probability was rounded to zero.
constexpr double kLeastProbability = 1e-6;

constexpr PerAxis kNone{kNotGiven, kNotGiven, kNotGiven};

double negative_log_likelihood(std::span<const float> probability, const HypothesisAxis& axis,
                               double truth) {
  const double position =
      std::clamp(truth / axis.step + axis.half_count(), 0.0, axis.count() - 1.0);
  const int below = std::min(static_cast<int>(position), axis.count() - 2);
  const double fraction = position - below;
  const double read = (1.0 - fraction) * probability[below] + fraction * probability[below + 1];
  return -std::log(std::max(read, kLeastProbability));
}

PerAxis error_of(const Se2& estimate, const Se2& truth) {
  return in_units(
      Se2{estimate.x_m - truth.x_m, estimate.y_m - truth.y_m, estimate.yaw_rad - truth.yaw_rad});
}

/// The share of the errors of an axis that are at most `sigmas` reported sigmas. Outcomes without a
/// sigma do not count. kNotGiven if none has one.
double coverage_of(const std::vector<Outcome>& outcomes, size_t axis, double sigmas) {
  size_t with_sigma = 0;
  size_t within = 0;
  for (const Outcome& outcome : outcomes) {
    if (std::isnan(outcome.sigma[axis])) continue;
    ++with_sigma;
    if (std::abs(outcome.error[axis]) <= sigmas * outcome.sigma[axis]) ++within;
  }
  if (with_sigma == 0) return kNotGiven;
  return static_cast<double>(within) / static_cast<double>(with_sigma);
}

Summary nothing_given() {
  return {.scenes = 0,
          .mae = kNone,
          .rmse = kNone,
          .median = kNone,
          .p95 = kNone,
          .parabola_mae = kNone,
          .nll = kNone,
          .coverage_1s = kNone,
          .coverage_3s = kNone,
          .time_ms = kNotGiven};
}

}  // namespace

PerAxis in_units(const Eigen::Vector3d& pose) {
  return {pose.x(), pose.y(), degrees(pose.z())};
}

PerAxis in_units(const Se2& pose) {
  return in_units(Eigen::Vector3d(pose.x_m, pose.y_m, pose.yaw_rad));
}

Outcome judge(const SolverResult& result, const HypothesisGrid& hypotheses, const Se2& truth) {
  Outcome outcome;
  outcome.error = error_of(result.correction, truth);
  outcome.parabola_error = error_of(result.parabola, truth);
  outcome.sigma = in_units(result.covariance.diagonal().cwiseSqrt());
  outcome.nll = {
      negative_log_likelihood(result.x_probability, hypotheses.x_m, truth.x_m),
      negative_log_likelihood(result.y_probability, hypotheses.y_m, truth.y_m),
      negative_log_likelihood(result.yaw_probability, hypotheses.yaw_rad, truth.yaw_rad)};
  return outcome;
}

Outcome judge_pose(const SolverResult& result, const HypothesisGrid& hypotheses, const Se2& truth) {
  Outcome outcome = judge(result, hypotheses, truth);
  outcome.sigma = in_units(pose_sigma(result));
  return outcome;
}

Outcome judge(const Se2& correction, const Se2& truth) {
  Outcome outcome;
  outcome.error = error_of(correction, truth);
  outcome.parabola_error = outcome.sigma = outcome.nll = kNone;
  return outcome;
}

Summary summarise(const std::vector<Outcome>& outcomes) {
  Summary summary;
  summary.scenes = outcomes.size();
  if (outcomes.empty()) return nothing_given();
  const double share = 1.0 / static_cast<double>(outcomes.size());
  std::vector<double> values(outcomes.size());
  for (size_t axis = 0; axis < 3; ++axis) {
    double square = 0.0;
    for (size_t i = 0; i < outcomes.size(); ++i) {
      const Outcome& outcome = outcomes[i];
      const double error = std::abs(outcome.error[axis]);
      values[i] = error;
      square += share * error * error;
      summary.mae[axis] += share * error;
      summary.parabola_mae[axis] += share * std::abs(outcome.parabola_error[axis]);
      summary.nll[axis] += share * outcome.nll[axis];
    }
    summary.coverage_1s[axis] = coverage_of(outcomes, axis, 1.0);
    summary.coverage_3s[axis] = coverage_of(outcomes, axis, 3.0);
    summary.rmse[axis] = std::sqrt(square);
    summary.median[axis] = quantile_of(values, 0.5);
    summary.p95[axis] = quantile_of(values, 0.95);
  }
  std::ranges::transform(outcomes, values.begin(), &Outcome::time_ms);
  summary.time_ms = quantile_of(values, 0.5);
  return summary;
}

}  // namespace bevloc::evaluation
