// Checks what the machine offers, whatever the configuration says.
#pragma once

#include "command/doctor/finding.h"
#include "command/doctor/machine.h"

namespace bevloc::command {

/// Checks the vector instructions of the CPU, and its frequency governor.
Findings check_cpu(const Machine& machine);
/// Checks the free memory, and the free space of the disk.
Findings check_room(const Machine& machine);
Findings check_clock(const Machine& machine);
/// Checks the state of bevlocd.service.
Findings check_unit(const Machine& machine);

/// Checks that a kernel module is loaded or built in.
Finding check_module(const Machine& machine, const std::string& module, Level if_missing);
/// Checks whether a module is loaded, built in, or there for the kernel, which loads it when it is
/// used first. It is a problem if the module is missing.
Finding check_module_on_demand(const Machine& machine, const std::string& module);

}  // namespace bevloc::command
