// Runs the appliance on the devices of a vehicle: what bevlocd does without a simulated drive.
#pragma once

#include <functional>
#include <memory>

#include "can/bus/bus.h"
#include "drivers/gpio/gpio.h"
#include "firmware/config/config.h"

namespace bevloc::firmware {

/// Opens the appliance's endpoint on the CAN bus.
using OpenBus = std::function<Result<std::unique_ptr<can::Bus>>()>;

/// Runs until `stop`, which is called about ten times per second, returns true or the ignition goes
/// off. Fails if the map, the model, the bus, a recording or a GPIO line cannot be opened. A camera
/// that fails is no error: CaptureStage restarts it. `gpio` must outlive the call.
Status run_daemon(const Config& config, const Rig& rig, drivers::Gpio& gpio,
                  const OpenBus& open_bus, const std::function<bool()>& stop);

/// Sets the least severe level that is logged.
void set_log_level(LogLevel level);

}  // namespace bevloc::firmware
