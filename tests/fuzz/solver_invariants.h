// What must hold of every result, whatever went in.
#pragma once

#include "common/result.h"
#include "pipeline/solver/solver.h"

namespace bevloc::fuzz {

/// Fails with the first that does not.
Status check_result(const SolverResult& result, const HypothesisGrid& hypotheses);

}  // namespace bevloc::fuzz
