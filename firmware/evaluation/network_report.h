// Tables of a model's evaluation, for people and for programs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/evaluation/network_evaluation.h"

namespace bevloc::evaluation {

/// What was evaluated.
struct NetworkEvaluationSubject {
  std::string model;  ///< the name that the model file gives itself
  std::string map;    ///< file; empty: made-up towns
  int frames = 0;
  uint64_t seed = 0;
};

/// A set's name, what it changes, its IoU, and a line for each read-out.
std::string table_of(const SetResult& result);

/// {"model", "map", "scenes", "seed", "rows": [{set, solver, iou, input, size, channels, step_m,
/// mae, rmse, ...}]}: a row for each set and read-out, its measures named as in `bevloc eval
/// solver` (summary_format.h). "solver" is also where a baseline's name stands.
std::string to_json(const std::vector<SetResult>& results, const NetworkEvaluationSubject& subject);
/// The same rows, a line each.
std::string to_csv(const std::vector<SetResult>& results);

}  // namespace bevloc::evaluation
