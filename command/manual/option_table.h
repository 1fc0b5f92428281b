// The commands and options of a program as plain data: help, manual pages and completion are made
// from it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace bevloc::command {

struct OptionEntry {
  std::vector<std::string> names;  ///< such as "--config"; the plain name of a positional argument
  std::string description;
  std::string value;                 ///< such as "FILE", "TEXT" or "UINT"; empty for a flag
  std::vector<std::string> choices;  ///< all values, if only some words are allowed
  std::string default_value;
  bool required = false;
  bool positional = false;
};

struct CommandEntry {
  std::string name;  ///< such as "network"
  std::string path;  ///< such as "eval network"; empty for the program
  std::string description;
  std::string footer;  ///< exit codes and examples
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;  ///< its subcommands
};

/// Reads the declarations of a program.
CommandEntry table_of(const CLI::App& app);

/// Returns the command and all commands below it, outermost first.
std::vector<const CommandEntry*> all_commands(const CommandEntry& command);

}  // namespace bevloc::command
