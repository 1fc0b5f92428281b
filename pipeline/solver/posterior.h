// Functions on the distributions over the hypotheses of an axis.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc {

/// probability = softmax(scale * scores).
void softmax(std::span<const double> scores, double scale, std::span<float> probability);

/// Redistributes the total probability of the hypotheses `chosen` among them, in proportion to
/// softmax(scale * scores). scores[i] belongs to hypothesis chosen[i]. The probabilities of all
/// other hypotheses stay the same.
void redistribute(std::span<const int> chosen, std::span<const double> scores, double scale,
                  std::span<float> probability);

double posterior_mean(std::span<const float> probability, const HypothesisAxis& axis);
double posterior_variance(std::span<const float> probability, const HypothesisAxis& axis);

/// The means of the three distributions of `result`.
Se2 mean_correction(const SolverResult& result, const HypothesisGrid& hypotheses);

/// The vertex of the parabola through the logarithms of the highest probability and its two
/// neighbours. If the highest is the first or the last hypothesis, it is the value of that
/// hypothesis.
double parabola_vertex(std::span<const float> probability, const HypothesisAxis& axis);

/// The second highest local maximum divided by the highest, or 0 if there is only one.
double rival_peak(std::span<const float> probability);

/// The probability of the hypotheses that are at the border of the axis or one step away from it.
double edge_mass(std::span<const float> probability);

/// A searched axis on which another axis depends: while the searched axis moved from `start` by d,
/// the dependent axis moved by slope * d.
struct SearchedAxis {
  std::span<const float> probability;
  const HypothesisAxis& axis;
  double start;
  double slope;
};

/// Convolves the distribution of a dependent axis with that of the searched axis:
///
///   P(v) = sum over i of searched.probability[i] * probability(v - slope * (value(i) - start)).
///
/// `probability` on entry is the distribution with the searched axis fixed at `start`; on return it
/// is the marginal. Shifts between hypotheses are interpolated linearly; probability that would
/// leave the axis stays at its end. `scratch` is overwritten.
void convolve(const SearchedAxis& searched, const HypothesisAxis& axis, std::vector<float>& scratch,
              std::vector<float>& probability);

/// The variances of x, y and yaw if all hypotheses are equally likely.
Eigen::Vector3d uniform_variance(const HypothesisGrid& hypotheses);

/// The smallest variances that a result may claim with these steps: (step / sqrt(12))^2 / 4.
Eigen::Vector3d least_variance(const HypothesisGrid& hypotheses);

/// Gives each distribution of `result` one element per hypothesis of its axis.
void resize_distributions(const HypothesisGrid& hypotheses, SolverResult& result);

/// Sets Evidence::kNone, a zero correction, uniform distributions and their covariance.
void set_no_evidence(const HypothesisGrid& hypotheses, SolverResult& result);

}  // namespace bevloc
