// Marginals of the joint distribution over all hypotheses.
#pragma once

#include <span>

#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc {

/// Computes the distributions (marginals) and the correction (their means) from the joint
/// probabilities [yaw, x, y]. The distributions of `result` must have the lengths of the axes.
void summarise_joint(std::span<const float> probability, const HypothesisGrid& hypotheses,
                     SolverResult& result);

}  // namespace bevloc
