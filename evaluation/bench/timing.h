// Times repeated runs of a function.
#pragma once

#include <functional>

#include "evaluation/bench/cost_model.h"

namespace bevloc::bench {

/// Calls `run` several times and returns the time of one run, in seconds.
using TimeOfRun = std::function<double(const std::function<void()>& run)>;

/// Times `repeats` runs, after one run that is not timed.
TimeSummary time_of(const std::function<void()>& run, int repeats);

}  // namespace bevloc::bench
