// Formats the results of the solver evaluation: tables, JSON and CSV.
#pragma once

#include <string>
#include <vector>

#include "evaluation/solver/solver_evaluation.h"

namespace bevloc::evaluation {

/// One line per case.
std::string accuracy_table(const std::vector<CaseResult>& results);
std::string cost_table(const std::vector<CaseResult>& results);
/// Errors and coverage of one case by kind of road.
std::string road_table(const CaseResult& result);
/// The rows of the paper's Tables III and IV, each with our results for the same case. Cases that
/// `results` lacks say "not run".
std::string paper_comparison(const std::vector<CaseResult>& results);

/// {"corruption", "scenes", "seed", "rows": [{solver, size, channels, step_m, mae, rmse, ...}]}.
std::string to_json(const std::vector<CaseResult>& results, const EvaluationOptions& options,
                    uint64_t seed);
/// One line for each case and kind of road; the road "all" stands for all scenes.
std::string to_csv(const std::vector<CaseResult>& results);

}  // namespace bevloc::evaluation
