// `bevloc demo`: the demo's drive, wherever bevloc is installed.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

/// Replaces itself by bevlocd with the demo's configuration.
class DemoCommand {
 public:
  void declare(CLI::App& app);
  Status run() const;

 private:
  std::vector<std::string> rest_;
};

}  // namespace bevloc::evaluation
