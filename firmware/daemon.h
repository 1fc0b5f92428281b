// bevlocd on cameras and a bus that are not simulated.
#pragma once

#include <functional>

#include "firmware/config.h"

namespace bevloc::firmware {

/// Runs until `stop` says so. Fails where the map, the model or the bus cannot be opened; a camera
/// that cannot be opened is tried again for ever instead.
Status run_daemon(const Config& config, const Rig& rig, const std::function<bool()>& stop);

void set_log_level(LogLevel level);

}  // namespace bevloc::firmware
