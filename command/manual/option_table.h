// The commands and options of a program as plain data: help, manual pages and completion are made
// from it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace bevloc::command {

struct OptionEntry {
  std::vector<std::string> names;  ///< "--config"; of a positional argument its name alone
  std::string description;
  std::string value;                 ///< "FILE", "TEXT", "UINT"; empty for a flag
  std::vector<std::string> choices;  ///< all values, where only some words are allowed
  std::string default_value;
  bool required = false;
  bool positional = false;
};

struct CommandEntry {
  std::string name;  ///< "network"
  std::string path;  ///< "eval network"; empty for the program
  std::string description;
  std::string footer;  ///< exit codes and examples
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;  ///< its subcommands
};

/// Reads the declarations of a program.
CommandEntry table_of(const CLI::App& app);

/// The command and all commands below it, outermost first.
std::vector<const CommandEntry*> all_commands(const CommandEntry& command);

}  // namespace bevloc::command
