// Runs a simulated drive with the daemon's own stages and compares the poses with the truth.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/mock/picture_cache.h"
#include "evaluation/drive/drive_config.h"
#include "evaluation/drive/drive_report.h"
#include "firmware/runtime/supervisor.h"

namespace bevloc::evaluation {

struct SimulatedRunOptions {
  bool fast = false;          ///< lockstep: virtual clock, one thread, as fast as possible
  bool show_progress = true;  ///< show_progress_line()
  std::filesystem::path out;  ///< folder for can.log, poses.csv and sheet.png
  /// Folder for the pictures and the reference poses (PictureRecorder); empty: none are written.
  std::filesystem::path pictures_folder{};
  /// Shares the drawn pictures with other runs, which may have other faults; null without a
  /// cache.
  std::shared_ptr<drivers::PictureCache> pictures;
};

/// Called about ten times a second. The run ends if it returns true.
using StopWhen = std::function<bool(const firmware::ApplianceView& view)>;

/// Runs the drive for the configured duration, or until `stop` returns true, and writes can.log,
/// poses.csv and sheet.png. `config.simulation` must be set. Fails if a file cannot be read or
/// written, if the appliance cannot be created, or if a thread shall hang in lockstep.
Result<DriveReport> run_simulation(const DriveConfig& config, const Rig& rig,
                                   const SimulatedRunOptions& options, const StopWhen& stop);

}  // namespace bevloc::evaluation
