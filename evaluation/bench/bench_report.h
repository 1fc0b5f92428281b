// Formats the results of the bench as a table and as JSON.
#pragma once

#include <string>
#include <vector>

#include "evaluation/bench/measurement.h"
#include "evaluation/bench/sweeps.h"

namespace bevloc::bench {

/// A table for a terminal, at most 100 columns wide.
std::string table_of(const BenchResult& result);
std::string table_of(const SweepResult& sweep);

/// The results as JSON. docs/performance.md describes the keys.
std::string to_json(const BenchResult& result);
std::string to_json(const std::vector<SweepResult>& sweeps);

}  // namespace bevloc::bench
