// `bevloc eval rig`: the accuracy that a rig will have, before anything is mounted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// Evaluates a model on the same simulated places with two rigs: the simulator's own, and one that
/// is read from a file or drawn at random. Prints the errors of both and their ratio.
class RigCommand {
 public:
  void declare(CLI::App& eval);
  Status run() const;

 private:
  struct NamedRig {
    std::string name;
    Rig rig;
  };
  /// Reads or draws the other rig. Writes a drawn one to the file that was asked for.
  Result<NamedRig> chosen_rig() const;

  std::string rig_file_;
  std::optional<uint64_t> drawn_seed_;
  std::string drawn_file_;
  std::string model_ = "models/nano.onnx";
  int frames_ = 200;
  uint64_t seed_ = 1;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
