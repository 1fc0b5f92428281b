// A whole simulated drive with the daemon's own stages, judged against the truth.
#pragma once

#include <filesystem>
#include <optional>

#include "firmware/config.h"
#include "firmware/simulation/drive_report.h"
#include "firmware/supervisor.h"

namespace bevloc::firmware {

struct SimulatedRunOptions {
  bool fast = false;          ///< virtual clock, one thread, as quick as it can
  bool show_progress = true;  ///< one live line on the terminal
  std::filesystem::path out;  ///< folder for can.log, poses.csv and sheet.png
};

/// Asked about ten times a second whether to end.
using StopWhen = std::function<bool(const ApplianceView& view)>;

/// Ends after the configured duration, or when `stop` says so. The configuration has a simulation.
Result<DriveReport> run_simulation(const Config& config, const Rig& rig,
                                   const SimulatedRunOptions& options, const StopWhen& stop);

}  // namespace bevloc::firmware
