// Runs a simulated drive with the daemon's own stages and compares the poses with the truth.
#pragma once

#include <filesystem>
#include <optional>

#include "evaluation/drive/drive_config.h"
#include "evaluation/drive/drive_report.h"
#include "firmware/runtime/supervisor.h"

namespace bevloc::evaluation {

struct SimulatedRunOptions {
  bool fast = false;          ///< lockstep: virtual clock, one thread, as fast as possible
  bool show_progress = true;  ///< show_progress_line()
  std::filesystem::path out;  ///< folder for can.log, poses.csv and sheet.png
};

/// Called about ten times a second. The run ends if it returns true.
using StopWhen = std::function<bool(const firmware::ApplianceView& view)>;

/// Runs the drive for the configured duration, or until `stop` returns true, and writes can.log,
/// poses.csv and sheet.png. `config.simulation` must be set. Fails if a file cannot be read or
/// written, or if the appliance cannot be created.
Result<DriveReport> run_simulation(const DriveConfig& config, const Rig& rig,
                                   const SimulatedRunOptions& options, const StopWhen& stop);

}  // namespace bevloc::evaluation
