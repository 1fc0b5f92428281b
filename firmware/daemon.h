// bevlocd on cameras and a bus that are not simulated.
#pragma once

#include <functional>

#include "drivers/gpio/gpio.h"
#include "firmware/config.h"

namespace bevloc::firmware {

/// Runs until `stop`, asked about ten times a second, says so or ignition goes off. Fails where the
/// map, the model, the bus, a recording or a line of `gpio` cannot be opened; a camera that fails
/// later is started again for ever (CaptureStage).
Status run_daemon(const Config& config, const Rig& rig, drivers::Gpio& gpio,
                  const std::function<bool()>& stop);

void set_log_level(LogLevel level);

}  // namespace bevloc::firmware
