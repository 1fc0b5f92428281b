#include "pipeline/solver/posterior.h"

#include <algorithm>
#include <cmath>

namespace bevloc {
namespace {

double uniform_variance(const HypothesisAxis& axis) {
  const double count = axis.count();
  return axis.step * axis.step * (count * count - 1.0) / 12.0;
}

}  // namespace

void softmax(std::span<const double> scores, double scale, std::span<float> probability) {
  const double best = *std::ranges::max_element(scores);
  double sum = 0.0;
  for (double score : scores) sum += std::exp(scale * (score - best));
  for (size_t i = 0; i < scores.size(); ++i) {
    probability[i] = static_cast<float>(std::exp(scale * (scores[i] - best)) / sum);
  }
}

void redistribute(std::span<const int> chosen, std::span<const double> scores, double scale,
                  std::span<float> probability) {
  const double best = *std::ranges::max_element(scores);
  double total = 0.0;
  double sum = 0.0;
  for (size_t i = 0; i < chosen.size(); ++i) {
    total += probability[chosen[i]];
    sum += std::exp(scale * (scores[i] - best));
  }
  for (size_t i = 0; i < chosen.size(); ++i) {
    probability[chosen[i]] = static_cast<float>(total * std::exp(scale * (scores[i] - best)) / sum);
  }
}

double posterior_mean(std::span<const float> probability, const HypothesisAxis& axis) {
  double mean = 0.0;
  for (int i = 0; i < axis.count(); ++i) mean += probability[i] * axis.value(i);
  return mean;
}

double posterior_variance(std::span<const float> probability, const HypothesisAxis& axis) {
  const double mean = posterior_mean(probability, axis);
  double variance = 0.0;
  for (int i = 0; i < axis.count(); ++i) {
    variance += probability[i] * (axis.value(i) - mean) * (axis.value(i) - mean);
  }
  return variance;
}

Se2 mean_correction(const SolverResult& result, const HypothesisGrid& hypotheses) {
  return {posterior_mean(result.x_probability, hypotheses.x_m),
          posterior_mean(result.y_probability, hypotheses.y_m),
          posterior_mean(result.yaw_probability, hypotheses.yaw_rad)};
}

double parabola_vertex(std::span<const float> probability, const HypothesisAxis& axis) {
  const auto best = std::ranges::max_element(probability);
  const int i = static_cast<int>(best - probability.begin());
  if (i == 0 || i + 1 == axis.count()) return axis.value(i);
  constexpr double kLeast = 1e-30;  // keeps the logarithm of a zero probability finite
  const double before = std::log(std::max<double>(*(best - 1), kLeast));
  const double top = std::log(std::max<double>(*best, kLeast));
  const double after = std::log(std::max<double>(*(best + 1), kLeast));
  const double curvature = before - 2.0 * top + after;
  if (curvature >= 0.0) return axis.value(i);  // flat: all three are equally likely
  return axis.value(i) + 0.5 * (before - after) / curvature * axis.step;
}

double rival_peak(std::span<const float> probability) {
  float highest = 0.0F;
  float second = 0.0F;
  for (size_t i = 0; i < probability.size(); ++i) {
    // A plateau counts once, at its first element.
    const bool above_previous = i == 0 || probability[i] > probability[i - 1];
    size_t next = i + 1;
    while (next < probability.size() && probability[next] == probability[i]) ++next;
    const bool above_next = next == probability.size() || probability[i] > probability[next];
    if (!above_previous || !above_next) continue;
    second = std::max(second, std::min(highest, probability[i]));
    highest = std::max(highest, probability[i]);
  }
  return highest > 0.0F ? second / highest : 0.0;
}

double edge_mass(std::span<const float> probability) {
  constexpr size_t kPerBorder = 2;
  double mass = 0.0;
  for (size_t i = 0; i < probability.size(); ++i) {
    if (i < kPerBorder || i + kPerBorder >= probability.size()) mass += probability[i];
  }
  return mass;
}

void convolve(const SearchedAxis& searched, const HypothesisAxis& axis, std::vector<float>& scratch,
              std::vector<float>& probability) {
  scratch.assign(probability.size(), 0.0F);
  const int last = axis.count() - 1;
  for (int i = 0; i < searched.axis.count(); ++i) {
    const double shift = searched.slope * (searched.axis.value(i) - searched.start) / axis.step;
    for (int k = 0; k <= last; ++k) {
      const double position = std::clamp(k + shift, 0.0, static_cast<double>(last));
      const int low = std::min(static_cast<int>(position), last - 1);
      const auto above = static_cast<float>(position - low);
      const float share = searched.probability[i] * probability[k];
      scratch[low] += (1.0F - above) * share;
      scratch[low + 1] += above * share;
    }
  }
  std::ranges::copy(scratch, probability.begin());
}

Eigen::Vector3d uniform_variance(const HypothesisGrid& hypotheses) {
  return {uniform_variance(hypotheses.x_m), uniform_variance(hypotheses.y_m),
          uniform_variance(hypotheses.yaw_rad)};
}

Eigen::Vector3d least_variance(const HypothesisGrid& hypotheses) {
  const Eigen::Vector3d step(hypotheses.x_m.step, hypotheses.y_m.step, hypotheses.yaw_rad.step);
  return step.cwiseAbs2() / (12.0 * 4.0);
}

void resize_distributions(const HypothesisGrid& hypotheses, SolverResult& result) {
  result.x_probability.resize(hypotheses.x_m.count());
  result.y_probability.resize(hypotheses.y_m.count());
  result.yaw_probability.resize(hypotheses.yaw_rad.count());
}

void set_no_evidence(const HypothesisGrid& hypotheses, SolverResult& result) {
  resize_distributions(hypotheses, result);
  result.evidence = Evidence::kNone;
  result.correction = Se2{};
  result.parabola = Se2{};
  result.score = 0.0;
  result.axis_score.setZero();
  result.edge_mass.setZero();
  result.rival_peak.setZero();
  result.evidence_share.setZero();
  result.covariance = uniform_variance(hypotheses).asDiagonal();
  for (auto* distribution :
       {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    std::ranges::fill(*distribution, 1.0F / static_cast<float>(distribution->size()));
  }
}

}  // namespace bevloc
