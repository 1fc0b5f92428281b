// The commands of the `bevloc` that a user of the packages calls.
#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

#include "command/manual/option_table.h"

namespace bevloc::command {

/// Returns the commands of a program. `folder` is where the program lies. In the packages, the
/// program with the simulator lies in libexec/bevloc-sim, and users call bin/bevloc, which passes
/// on the commands that it does not have (command/bevloc.cpp). There the entries of the commands
/// that both have are those of bin/bevloc, which knows no mock cameras.
CommandEntry installed_table(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace bevloc::command
