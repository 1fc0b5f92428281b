#include "pipeline/solver/reference/joint_posterior.h"

#include <algorithm>

#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

/// Calls visit(i, j, k, p) for every hypothesis (x_i, y_j, yaw_k) with its probability p.
template <typename Visit>
void for_each(std::span<const float> probability, const HypothesisGrid& hypotheses, Visit visit) {
  const float* p = probability.data();
  for (int k = 0; k < hypotheses.yaw_rad.count(); ++k) {
    for (int i = 0; i < hypotheses.x_m.count(); ++i) {
      for (int j = 0; j < hypotheses.y_m.count(); ++j) visit(i, j, k, *p++);
    }
  }
}

}  // namespace

void summarise_joint(std::span<const float> probability, const HypothesisGrid& hypotheses,
                     SolverResult& result) {
  for (auto* marginal : {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    std::ranges::fill(*marginal, 0.0F);
  }
  for_each(probability, hypotheses, [&](int i, int j, int k, float p) {
    result.x_probability[i] += p;
    result.y_probability[j] += p;
    result.yaw_probability[k] += p;
  });
  result.correction = mean_correction(result, hypotheses);
}

}  // namespace bevloc
