// `bevloc draw solver`: its options and what it does.
#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class DrawCommand {
 public:
  void declare(CLI::App& draw);

  /// Does what the command line asked for.
  Status run() const;

 private:
  uint64_t scene_ = 0;
  std::string folder_;
};

}  // namespace bevloc::evaluation
