// Looks up on this machine what a configuration names.
#pragma once

#include "firmware/config/config.h"

namespace bevloc::firmware {

/// Checks on this machine everything that the configuration names (`bevlocd --check-config`): reads
/// rig, model, map and recordings, runs network and solvers on the test frame (Localizer::check()),
/// looks up the GPIO lines, opens the CAN interface, and starts the cameras. Returns the first
/// error. The test frame takes as long as a few matches.
Status check_config(const Config& config);

}  // namespace bevloc::firmware
