// Checks the properties that every solver result must have, for any input.
#pragma once

#include "common/result.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc::fuzz {

/// Fails with the first property that does not hold. `score_scale`: the solver's parameter.
Status check_result(const SolverResult& result, const HypothesisGrid& hypotheses,
                    double score_scale);

}  // namespace bevloc::fuzz
