// Times, allocations and memory of a run.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.h"
#include "firmware/bench/cost_model.h"
#include "firmware/bench/resident_memory.h"
#include "firmware/config.h"

namespace bevloc::bench {

struct BenchOptions {
  int frames = 200;
  int threads = 1;
  std::vector<std::string> stages;  ///< of kStageNames; none: all, and the whole frame
};

struct StageResult {
  std::string name;
  bool in_frame = false;
  Work work;
  TimeSummary time;
  double allocations = 0.0;  ///< per frame
};

/// What each part adds to the process, and the process at the end.
struct MemoryResult {
  double program_mib = 0.0;    ///< before anything is made: code and libraries
  double map_mib = 0.0;        ///< the map with its index
  double appliance_mib = 0.0;  ///< network, solvers, stages and queues, after the first frames
  double pictures_mib = 0.0;   ///< of the bench
  ResidentMemory process;

  /// What a daemon holds of this.
  double daemon_mib() const { return program_mib + map_mib + appliance_mib; }
};

struct BenchResult {
  std::string model;
  int frames = 0;
  int threads = 1;
  int places = 0;
  std::string processor;
  std::string instruction_set;
  MachinePeak peak;
  bool allocations_counted = false;
  std::vector<StageResult> stages;
  std::optional<StageResult> whole_frame;
  MemoryResult memory;

  /// Over the stages that are in a frame.
  double sum_of_stages_ms() const;
  double sum_of_ideals_ms() const;
  /// Of the whole frame, what no stage accounts for; zero without a whole frame.
  double outside_ms() const;
};

/// Whole frames and stages by turns, a few of each at a time, at several places. Fails where
/// configuration, model, map or rig do, and where no place lets the pose be tracked.
Result<BenchResult> run_bench(const firmware::Config& config, const BenchOptions& options,
                              const std::function<void(int done, int all)>& progress);

}  // namespace bevloc::bench
