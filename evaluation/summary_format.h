// Formats a Summary for tables, JSON and CSV. A value of kNotGiven becomes "-" in a table, null in
// JSON and empty in CSV.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "evaluation/solver/solver_score.h"

namespace bevloc::evaluation {

/// "0.115".
std::string number_or_dash(double value, int digits);

/// "0.115 0.042 0.148".
std::string three(const PerAxis& values, int digits = 3);

/// Shares as whole per cent: " 68  70  71".
std::string percent(const PerAxis& shares);

/// {mae, rmse, median, p95, parabola_mae, nll, coverage_1s, coverage_3s: [x, y, yaw], scenes}.
nlohmann::json json_of(const Summary& summary);

/// One value of a CSV line, with a comma before it.
std::string csv_value(double value);

/// CSV columns for everything in json_of() but the number of scenes: the names, and the values.
/// Each begins with a comma.
std::string csv_columns();
std::string csv_values(const Summary& summary);

}  // namespace bevloc::evaluation
