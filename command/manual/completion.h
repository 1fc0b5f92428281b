// Writes completion scripts for bash and zsh from the option table of a program.
#pragma once

#include <string>

#include "command/manual/option_table.h"

namespace bevloc::command {

/// Return a script that completes subcommands, options, words, files and folders of `program`.
std::string bash_completion(const std::string& program, const CommandEntry& table);
std::string zsh_completion(const std::string& program, const CommandEntry& table);

}  // namespace bevloc::command
