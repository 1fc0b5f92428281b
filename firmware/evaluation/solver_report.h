// Tables of an evaluation, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "firmware/evaluation/solver_evaluation.h"

namespace bevloc::evaluation {

/// Accuracy and cost of every case.
std::string accuracy_table(const std::vector<CaseResult>& results);
std::string cost_table(const std::vector<CaseResult>& results);
/// Errors and coverage of one case by kind of road.
std::string road_table(const CaseResult& result);
/// The rows of the paper's Tables III and IV beside ours, as far as `results` have them.
std::string paper_comparison(const std::vector<CaseResult>& results);

/// {"corruption", "scenes", "seed", "rows": [{solver, size, channels, step_m, mae, rmse, ...}]}.
std::string to_json(const std::vector<CaseResult>& results, const EvaluationOptions& options,
                    uint64_t seed);
/// One line for each case and kind of road ("all" for all of them).
std::string to_csv(const std::vector<CaseResult>& results);

}  // namespace bevloc::evaluation
