// `bevloc replay`: runs the real pipeline on a recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/recording/replay_setup.h"

namespace bevloc::evaluation {

class ReplayCommand {
 public:
  void declare(CLI::App& app);
  bool chosen() const { return chosen_; }
  Status run() const;

 private:
  Status replay_recording() const;
  Status replay_candump() const;
  Status write_poses(const ReplayOutcome& outcome, Time begin) const;

  bool chosen_ = false;
  std::vector<std::filesystem::path> files_;
  ReplayOverrides overrides_;
  std::filesystem::path candump_;
  std::filesystem::path images_;
  std::filesystem::path out_ = "replay";
  std::string json_file_;
};

}  // namespace bevloc::evaluation
