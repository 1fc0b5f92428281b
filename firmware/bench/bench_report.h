// Results as a table for the terminal and as JSON.
#pragma once

#include <string>
#include <vector>

#include "firmware/bench/measurement.h"
#include "firmware/bench/sweeps.h"

namespace bevloc::bench {

/// At most 100 columns wide.
std::string table_of(const BenchResult& result);
std::string table_of(const SweepResult& sweep);

/// docs/performance.md describes the keys.
std::string to_json(const BenchResult& result);
std::string to_json(const std::vector<SweepResult>& sweeps);

}  // namespace bevloc::bench
