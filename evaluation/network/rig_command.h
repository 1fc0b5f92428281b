// `bevloc eval rig`: what a rig will cost before anything is mounted.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

/// Evaluates a model on the same simulated places with the simulator's own rig and with the rig of
/// a file, and prints both errors and their ratio.
class RigCommand {
 public:
  void declare(CLI::App& eval);
  bool chosen() const { return chosen_; }
  Status run() const;

 private:
  bool chosen_ = false;
  std::string rig_file_;
  std::string model_ = "models/nano.onnx";
  int frames_ = 200;
  uint64_t seed_ = 1;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
