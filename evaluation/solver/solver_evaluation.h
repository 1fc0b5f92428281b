// Runs solvers on synthetic scenes that no tuning has used.
#pragma once

#include <functional>
#include <vector>

#include "common/result.h"
#include "evaluation/solver/solver_case.h"
#include "evaluation/solver/solver_score.h"
#include "sim/perception/corruption.h"

namespace bevloc::evaluation {

struct EvaluationOptions {
  uint64_t seed_base = 0;  ///< see sim::SceneSampler
  int scenes = 200;
  sim::CorruptionLevel corruption = sim::CorruptionLevel::kPaper;
};

struct CaseResult {
  SolverCase solver_case;
  std::vector<Outcome> outcomes;  ///< one per scene
  size_t buffer_bytes = 0;        ///< heap memory of the solver, without its two inputs
};

/// Solves every scene with every case. `parameters` has one entry per case. Calls `progress` after
/// each scene with the number of finished scenes. Fails as make_solver() does.
Result<std::vector<CaseResult>> evaluate_solvers(const std::vector<SolverCase>& cases,
                                                 const std::vector<SolverParameters>& parameters,
                                                 const EvaluationOptions& options,
                                                 const std::function<void(int done)>& progress);

}  // namespace bevloc::evaluation
