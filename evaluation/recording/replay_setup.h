// Finds what a replay needs: configuration, calibration, model and map of a recording.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "evaluation/recording/replay.h"

namespace bevloc::evaluation {

/// What the command line overrides; empty: as recorded.
struct ReplayOverrides {
  std::filesystem::path config;  ///< with its calibration, model and solver
  std::filesystem::path model;
  std::filesystem::path map;
};

/// A folder for files that the recording contains, removed at the end.
class ScratchFolder {
 public:
  static Result<ScratchFolder> create();
  ~ScratchFolder();
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};

/// The configuration is the recorded one. Files that it names are taken from where they were if
/// they are still the same, else from the recording. Its manifest is not checked. Authentication is
/// left out, because a recording holds no key. Fails if the configuration takes GNSS from gpsd and
/// the recording has no positions of gpsd. Warns if the model or the version of bevloc is another
/// one than recorded.
Result<ReplaySetup> setup_of(Recording& recording, const ReplayOverrides& overrides,
                             const ScratchFolder& scratch);

/// The setup for a candump log: a configuration and nothing recorded. Fails if the configuration
/// takes GNSS from gpsd.
Result<ReplaySetup> setup_of(const ReplayOverrides& overrides);

}  // namespace bevloc::evaluation
