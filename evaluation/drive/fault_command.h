// `bevloc fault`: sets, lists and clears the faults of a running simulated drive.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class FaultCommand {
 public:
  void declare(CLI::App& app);

  /// Does what the parsed command line asks for.
  Status run() const;

 private:
  std::string verb_;
  std::string socket_;
  std::vector<std::string> words_;
};

}  // namespace bevloc::evaluation
