// The commands of the `bevloc` that a user of the packages calls.
#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

#include "command/manual/option_table.h"

namespace bevloc::command {

/// Returns the commands that a user can call. `folder` is the folder of the running program. The
/// packages install two programs: bin/bevloc, and one with the simulator in libexec/bevloc-sim.
/// Users call bin/bevloc, which passes on the commands that it does not have (command/bevloc.cpp).
/// If both programs have a command, the table describes the one of bin/bevloc, which knows no mock
/// cameras.
CommandEntry installed_table(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace bevloc::command
