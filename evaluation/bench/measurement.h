// Runs the bench: times, allocations and memory.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.h"
#include "evaluation/bench/cost_model.h"
#include "evaluation/bench/resident_memory.h"
#include "evaluation/drive/drive_config.h"

namespace bevloc::bench {

struct BenchOptions {
  int frames = 200;
  int threads = 1;
  std::vector<std::string> stages;  ///< from kStageNames; empty: all, and the whole frame
  bool measures_peak = true;        ///< the machine's peak, with which the stages are compared
};

struct StageResult {
  std::string name;
  bool in_frame = false;  ///< see Stage
  Work work;
  TimeSummary time;
  double allocations = 0.0;  ///< per frame
};

/// The memory that each part adds to the process, and the memory of the whole process.
struct MemoryResult {
  double program_mib = 0.0;    ///< code and libraries, at the start
  double map_mib = 0.0;        ///< the map with its index
  double appliance_mib = 0.0;  ///< network, solvers, stages and queues, after some frames
  double images_mib = 0.0;     ///< rendered images, in the bench only
  ResidentMemory process;

  /// The memory of a daemon.
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

  /// Sums over the stages of a frame.
  double sum_of_stages_ms() const;
  double sum_of_ideals_ms() const;
  /// The time of the whole frame minus the sum of its stages; 0 if no whole frame was measured.
  double outside_ms() const;
};

/// Times whole frames and stages alternately, in small groups, at several places. Calls `progress`
/// after each group. Fails if configuration, model, map or rig cannot be used, or if the pose is
/// tracked at no place.
Result<BenchResult> run_bench(const evaluation::DriveConfig& config, const BenchOptions& options,
                              const std::function<void(int done, int all)>& progress);

}  // namespace bevloc::bench
