// Finds the softmax scales of features that no training made.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/evaluation/solver_evaluation.h"

namespace bevloc::evaluation {

/// The mean negative log-likelihood of a solver with each of the parameters.
using ScaleTrial =
    std::function<Result<std::vector<PerAxis>>(const std::vector<SolverParameters>&)>;

/// The scales that a solver of this kind reads, each the one of a geometric row of candidates with
/// the least negative log-likelihood in the trial; a refined solver finds those of the refinement
/// alone. The others stay as in `start`. Fails as the trial does.
Result<SolverParameters> best_scales(SolverKind kind, const SolverParameters& start,
                                     const ScaleTrial& trial);

/// best_scales() on made-up scenes, from hand_made_parameters().
Result<SolverParameters> tune_scales(const SolverCase& solver_case,
                                     const EvaluationOptions& options);

/// "joint 57, axes 41 80 20, refine 80 110 110"; the axes are also those of bands.
std::string describe(const SolverParameters& parameters);

}  // namespace bevloc::evaluation
