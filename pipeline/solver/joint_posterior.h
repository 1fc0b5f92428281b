// The distribution over all hypotheses at once, and what it says of each axis.
#pragma once

#include <span>

#include "pipeline/solver/solver.h"

namespace bevloc {

/// Fills `result` from joint probabilities [yaw, x, y]: the marginals and their means. `result`
/// must have its distributions' lengths.
void summarise_joint(std::span<const float> probability, const HypothesisGrid& hypotheses,
                     SolverResult& result);

}  // namespace bevloc
