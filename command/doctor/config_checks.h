// Checks what a configuration names: files, devices, interface, limits.
#pragma once

#include "command/doctor/finding.h"
#include "command/doctor/machine.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// Checks that rig, model, map and key file are readable, and shows their SHA-256.
Findings check_files(const firmware::Config& config);
/// Checks that the configured cameras, recordings and GPIO lines exist, and that this user may use
/// them.
Findings check_devices(const Machine& machine, const firmware::Config& config);
/// Checks the limits that the section `realtime` needs.
Findings check_realtime(const Machine& machine, const firmware::Config& config);
/// Checks the CAN interface: its modules, state, bit rate and errors.
Findings check_can_interface(const Machine& machine, const firmware::Config& config);

}  // namespace bevloc::command
