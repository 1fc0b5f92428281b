// Runs the appliance on the devices of a vehicle. bevlocd does this unless it runs a simulated
// drive.
#pragma once

#include <functional>
#include <memory>

#include "can/bus/bus.h"
#include "drivers/gpio/gpio.h"
#include "firmware/config/config.h"
#include "firmware/telemetry/log_writer.h"

namespace bevloc::firmware {

/// Opens the appliance's endpoint on the CAN bus.
using OpenBus = std::function<Result<std::unique_ptr<can::Bus>>()>;

/// What the daemon gets from its program. `gpio` and `log` must outlive run_daemon().
struct DaemonHost {
  drivers::Gpio& gpio;
  OpenBus open_bus;            ///< called at each start of the appliance
  std::function<bool()> stop;  ///< called about ten times per second; true ends the daemon
  const LogWriter* log;        ///< the log whose thread is watched; null without one
};

/// Runs until `stop` returns true. While the ignition is off, the appliance is not running: the
/// daemon waits in standby and starts it when the ignition returns. Fails if the map, the model,
/// the bus or a GPIO line cannot be opened, or if at a start of the appliance a file is not the one
/// in the manifest. A camera that fails is no error: CaptureStage restarts it. If no recording can
/// be written, or the live page cannot be served, the daemon logs an error and goes on.
Status run_daemon(const Config& config, const Rig& rig, const DaemonHost& host);

/// Sets the least severe level that is logged.
void set_log_level(LogLevel level);

}  // namespace bevloc::firmware
