// bevlocd on cameras and a bus that are not simulated.
#pragma once

#include <functional>

#include "firmware/config.h"

namespace bevloc::firmware {

/// Runs until `stop` says so. Fails where the map, the model, the bus or a recording cannot be
/// opened; a camera that fails later is started again for ever (CaptureStage).
Status run_daemon(const Config& config, const Rig& rig, const std::function<bool()>& stop);

void set_log_level(LogLevel level);

}  // namespace bevloc::firmware
