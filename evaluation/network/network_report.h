// Formats the results of the evaluation of a model: table, JSON and CSV.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "evaluation/network/network_evaluation.h"

namespace bevloc::evaluation {

/// The model, and the samples that it was evaluated on.
struct NetworkEvaluationSubject {
  std::string model;  ///< the name stored in the model file
  std::string map;    ///< file; empty: procedural towns
  int samples = 0;    ///< per set
  uint64_t seed = 0;
};

/// The set's name and nuisances, its IoU, and a line per method.
std::string table_of(const SetResult& result);

/// {"model", "map", "scenes", "seed", "rows": [{set, solver, iou, input, size, channels, step_m,
/// mae, rmse, ...}]}: a row for each set and method, with the measures of summary_format.h.
/// "solver" is the name of the method, also for a baseline.
std::string to_json(const std::vector<SetResult>& results, const NetworkEvaluationSubject& subject);
/// The same rows, one per line.
std::string to_csv(const std::vector<SetResult>& results);

}  // namespace bevloc::evaluation
