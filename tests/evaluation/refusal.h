// What a command says when it refuses its options.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::test {

/// The error message of a command with this command line; "nothing" if it succeeds.
template <typename Command>
std::string refusal_of(std::vector<std::string> words) {
  CLI::App app;
  Command command;
  command.declare(app);
  std::ranges::reverse(words);  // as CLI11 expects
  app.parse(words);
  const auto status = command.run();
  return status ? "nothing" : status.error().message;
}

}  // namespace bevloc::test
