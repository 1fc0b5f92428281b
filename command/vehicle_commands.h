// The commands that every `bevloc` has, with the simulator or without.
#pragma once

#include <CLI/CLI.hpp>

#include "command/command_list.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// Adds --version and the commands that need no simulator. `simulation` reads the parts of a
/// configuration that only a program with the simulator supports. It is null in a program without
/// the simulator, and must outlive `commands`.
void add_vehicle_commands(CLI::App& app, CommandList& commands,
                          const firmware::SimulationReader* simulation);

}  // namespace bevloc::command
