// Finds softmax scales for features that do not come from training.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluation/solver/solver_evaluation.h"

namespace bevloc::evaluation {

/// Returns the mean negative log-likelihood of a solver for each set of parameters.
using ScaleTrial =
    std::function<Result<std::vector<PerAxis>>(const std::vector<SolverParameters>&)>;

/// Sets each scale that a solver of this kind uses to the candidate with the lowest negative
/// log-likelihood in the trial; the candidates form a geometric series. For a refined solver only
/// the scales of the refinement are set. All other scales stay as in `start`. Fails as the trial
/// does.
Result<SolverParameters> best_scales(SolverKind kind, const SolverParameters& start,
                                     const ScaleTrial& trial);

/// best_scales() on synthetic scenes, starting from hand_made_parameters().
Result<SolverParameters> tune_scales(const SolverCase& solver_case,
                                     const EvaluationOptions& options);

/// "joint 57, axes 41 80 20, refine 80 110 110". The banded solvers use the scales of the axes.
std::string describe(const SolverParameters& parameters);

}  // namespace bevloc::evaluation
