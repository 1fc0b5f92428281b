// `bevloc draw solver`: its options, and its execution.
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class DrawCommand {
 public:
  void declare(CLI::App& draw);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  uint64_t scene_ = 0;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
