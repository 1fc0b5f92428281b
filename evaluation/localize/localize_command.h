// `bevloc localize`: localizes six picture files.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/localize/prior_text.h"
#include "pipeline/localization/localizer.h"

namespace bevloc::evaluation {

/// Runs the daemon's own path (preprocessing, network, solver) on one set of pictures, and says
/// where they were taken and how sure that is. With --truth it judges the answers for random priors
/// around a pose that is known.
class LocalizeCommand {
 public:
  void declare(CLI::App& app);
  Status run() const;

 private:
  std::string rig_file_;
  std::string map_file_;
  std::string image_folder_;
  std::string prior_;
  PoseFrame frame_ = PoseFrame::kGuess;
  std::string motion_file_;
  std::string model_ = "models/nano.onnx";
  SolverKind solver_ = SolverKind::kBandedRefined;
  bool wide_ = false;
  bool truth_ = false;
  int priors_ = 0;
  uint64_t seed_ = 1;
  std::string json_file_;
  std::string sheet_file_;
};

}  // namespace bevloc::evaluation
