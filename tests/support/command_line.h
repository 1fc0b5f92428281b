// Runs commands of `bevloc` as from a command line.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

namespace bevloc::test {

inline void parse(CLI::App& app, std::vector<std::string> words) {
  std::ranges::reverse(words);  // as CLI11 expects
  app.parse(words);
}

/// Runs a command with this command line, whose first word is the name of the command. The
/// constructor of the command gets the other arguments.
template <typename Command, typename... Arguments>
auto run_command(const std::vector<std::string>& words, Arguments&&... of_command) {
  CLI::App app;
  Command command(std::forward<Arguments>(of_command)...);
  command.declare(app);
  parse(app, words);
  EXPECT_TRUE(app.got_subcommand(words.front()));
  return command.run();
}

}  // namespace bevloc::test
