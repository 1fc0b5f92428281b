// Distributions over the hypotheses of an axis.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pipeline/solver/solver.h"

namespace bevloc {

/// probability = softmax(scale * scores).
void softmax(std::span<const double> scores, double scale, std::span<float> probability);

/// Shares what the `chosen` hypotheses have together out among them, in proportion to
/// softmax(scale * scores); `scores` are theirs. The others keep what they have.
void share_out(std::span<const int> chosen, std::span<const double> scores, double scale,
               std::span<float> probability);

double posterior_mean(std::span<const float> probability, const HypothesisAxis& axis);
double posterior_variance(std::span<const float> probability, const HypothesisAxis& axis);

/// The top of the parabola through the logarithms of the greatest probability and its neighbours;
/// the hypothesis itself where it is the first or the last.
double parabola_top(std::span<const float> probability, const HypothesisAxis& axis);

/// The second highest local maximum against the highest; 0 where there is one only.
double rival_peak(std::span<const float> probability);

/// An axis whose search another one followed: its distribution, where the search began, and how far
/// the other went for each unit.
struct FollowedAxis {
  std::span<const float> probability;
  const HypothesisAxis& axis;
  double from;
  double slope;
};

/// The distribution of what followed, from what it is with the followed axis held:
/// P(v) = sum over i of followed.probability[i] * probability(v - slope * (value(i) - from)),
/// linear between hypotheses; what leaves the axis stays at its end. `scratch` is overwritten.
void spread(const FollowedAxis& followed, const HypothesisAxis& axis, std::vector<float>& scratch,
            std::vector<float>& probability);

/// Variances of x, y and yaw when every hypothesis is as likely as any other.
Eigen::Vector3d uniform_variance(const HypothesisGrid& hypotheses);

/// The smallest variances that a grid of these steps may claim: (step / sqrt(12))^2 / 4.
Eigen::Vector3d least_variance(const HypothesisGrid& hypotheses);

/// Makes the distributions as long as the axes have hypotheses.
void resize_distributions(const HypothesisGrid& hypotheses, SolverResult& result);

/// Zero correction, uniform distributions and their covariance.
void set_no_evidence(const HypothesisGrid& hypotheses, SolverResult& result);

}  // namespace bevloc
