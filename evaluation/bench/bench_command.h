// `bevloc bench`: its options, and its execution.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/bench/measurement.h"
#include "evaluation/drive/drive_config.h"

namespace bevloc::bench {

class BenchCommand {
 public:
  void declare(CLI::App& app);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  Status measure(const evaluation::DriveConfig& config) const;
  Status sweep(const evaluation::DriveConfig& config) const;

  std::string config_file_ = "config/demo.yaml";
  BenchOptions options_;
  std::vector<std::string> sweeps_;
  std::string json_file_;
};

}  // namespace bevloc::bench
