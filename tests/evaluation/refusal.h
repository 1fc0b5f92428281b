// What a command says when it refuses its options.
#pragma once

#include <string>
#include <vector>

#include "tests/support/command_line.h"

namespace bevloc::test {

/// The error message of a command with this command line; "nothing" if it succeeds.
template <typename Command>
std::string refusal_of(const std::vector<std::string>& words) {
  const auto status = run_command<Command>(words);
  return status ? "nothing" : status.error().message;
}

}  // namespace bevloc::test
