// Runs solvers on scenes that nothing was tuned on.
#pragma once

#include <functional>
#include <vector>

#include "common/result.h"
#include "firmware/evaluation/solver_case.h"
#include "firmware/evaluation/solver_score.h"
#include "sim/perception/corruption.h"

namespace bevloc::evaluation {

struct EvaluationOptions {
  uint64_t seed_base = 0;  ///< of sim::SceneSampler
  int scenes = 200;
  sim::CorruptionLevel corruption = sim::CorruptionLevel::kPaper;
};

struct CaseResult {
  SolverCase solver_case;
  std::vector<Outcome> outcomes;  ///< one for each scene
  size_t buffer_bytes = 0;        ///< that the solver holds beyond its two inputs
};

/// `progress` is called after each scene with the number that are done.
Result<std::vector<CaseResult>> evaluate_solvers(const std::vector<SolverCase>& cases,
                                                 const std::vector<SolverParameters>& parameters,
                                                 const EvaluationOptions& options,
                                                 const std::function<void(int done)>& progress);

}  // namespace bevloc::evaluation
