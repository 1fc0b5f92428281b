// Finds the softmax scales of features that no training made.
#pragma once

#include <string>

#include "firmware/evaluation/solver_evaluation.h"

namespace bevloc::evaluation {

/// The scales that the solver of a case reads, each the one of a geometric row of candidates with
/// the least mean negative log-likelihood on the scenes; the others keep their defaults. A refined
/// solver starts from hand_made_parameters() and finds joint_scale.
Result<SolverParameters> tune_scales(const SolverCase& solver_case,
                                     const EvaluationOptions& options);

/// "joint 57, x 41, y 80, yaw 20, banded 57 80".
std::string describe(const SolverParameters& parameters);

}  // namespace bevloc::evaluation
