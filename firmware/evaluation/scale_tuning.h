// Finds the softmax scales of features that no training made.
#pragma once

#include <string>

#include "firmware/evaluation/solver_evaluation.h"

namespace bevloc::evaluation {

/// The scales that the solver of a case reads, each the one of a geometric row of candidates with
/// the least mean negative log-likelihood on the scenes; the others keep their defaults. A refined
/// solver starts from hand_made_parameters() and finds those of the refinement.
Result<SolverParameters> tune_scales(const SolverCase& solver_case,
                                     const EvaluationOptions& options);

/// "joint 57, axes 41 80 20, refine 80 110 110"; the axes are also those of bands.
std::string describe(const SolverParameters& parameters);

}  // namespace bevloc::evaluation
