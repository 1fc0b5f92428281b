// `bevloc tune matches`: measures the matches that the modelled matcher of the campaign replays.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class TuneMatchesCommand {
 public:
  void declare(CLI::App& tune);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  std::string config_ = "config/demo.yaml";
  int drives_ = 6;
  uint64_t first_seed_ = 2000;
  double duration_s_ = 60.0;
  std::vector<std::string> maps_;
  std::string csv_file_;
};

}  // namespace bevloc::evaluation
