// `bevloc eval network`: its options, and its execution.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/solver/read_out_case.h"
#include "sim/samples/nuisances.h"

namespace bevloc::evaluation {

class NetworkCommand {
 public:
  void declare(CLI::App& eval);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  Result<std::vector<sim::NuisanceSet>> sets() const;

  std::string model_ = "models/nano.onnx";
  std::string set_ = "standard";
  ReadOutRows rows_ = ReadOutRows::kSolvers;
  std::string map_file_;
  int frames_ = 200;
  uint64_t seed_ = 1;
  std::string json_file_;
  std::string csv_file_;
};

}  // namespace bevloc::evaluation
