// Looks up on this machine what a configuration names.
#pragma once

#include <filesystem>

#include "common/result.h"
#include "firmware/config/config.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::firmware {

/// Fails if a camera shows too little for the network, and logs the warning if it shows less than
/// it should (check_views()). Messages name `file`, the rig file.
Status check_shown(const Rig& rig, const std::filesystem::path& file);

/// Checks on this machine everything that the configuration names (`bevlocd --check-config`): reads
/// rig, model, map and picture folders, runs network and solvers on the test frame
/// (Localizer::check()), looks up the GPIO lines, opens the CAN interface, and starts the cameras.
/// Returns the first error. The test frame takes as long as a few matches.
Status check_config(const Config& config);

}  // namespace bevloc::firmware
