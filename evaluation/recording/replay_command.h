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
  Status run() const;

 private:
  std::filesystem::path can_log() const { return out_ / "can.log"; }
  std::filesystem::path poses_file() const { return out_ / "poses.csv"; }
  /// Fails if the replay would write over a file that it reads.
  Status check_outputs() const;
  Status replay_recording() const;
  Status replay_candump() const;
  Status write_poses(const ReplayOutcome& outcome, Time begin) const;

  std::vector<std::filesystem::path> files_;
  ReplayOverrides overrides_;
  std::filesystem::path candump_;
  std::filesystem::path images_;
  std::filesystem::path out_ = "replay";
  std::filesystem::path json_file_;
};

}  // namespace bevloc::evaluation
