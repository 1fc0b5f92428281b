// `bevloc bench`: its options and what it does.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "firmware/bench/measurement.h"

namespace bevloc::bench {

class BenchCommand {
 public:
  void declare(CLI::App& app);

  /// Does what the command line asked for.
  Status run() const;

  /// Whether the command line asked for it.
  bool chosen() const { return chosen_; }

 private:
  Status measure(const firmware::Config& config) const;
  Status sweep(const firmware::Config& config) const;

  bool chosen_ = false;
  std::string config_file_ = "config/demo.yaml";
  BenchOptions options_;
  std::vector<std::string> sweeps_;
  std::string json_file_;
  std::string figure_file_;
};

}  // namespace bevloc::bench
