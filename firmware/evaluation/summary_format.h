// A summary as all tables write it. What is not given is "-" in a table, null in JSON and empty in
// CSV.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "firmware/evaluation/solver_score.h"

namespace bevloc::evaluation {

/// "0.115 0.042 0.148".
std::string three(const PerAxis& values, int digits = 3);

/// " 68  70  71" of shares.
std::string percent(const PerAxis& shares);

/// {mae, rmse, median, p95, parabola_mae, nll, coverage_1s, coverage_3s: [x, y, yaw], scenes}.
nlohmann::json json_of(const Summary& summary);

/// The same but for the scenes, as columns of CSV: their names, and their values. Each begins with
/// a comma.
std::string csv_columns();
std::string csv_values(const Summary& summary);

}  // namespace bevloc::evaluation
