// Writes the pictures of a simulated drive to a picture folder.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "common/result.h"
#include "drivers/frameset/frameset.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

/// The folder is what replay cameras play (drivers/camera/replay), with the reference poses in
/// reference.csv and the map in map.bvm. One thread.
class PictureRecorder {
 public:
  explicit PictureRecorder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Creates the folder and removes the indexes, the reference and the map of an earlier drive, so
  /// that they are not taken for those of this drive.
  Status begin();

  /// Writes the pictures of a frameset. After a failure it does nothing, and finish() returns the
  /// error.
  void record(const drivers::Frameset& frameset);

  /// Writes the indexes, the reference and the map.
  Status finish(const ReferenceTrajectory& reference, const HdMap& map);

 private:
  Status write_pictures(const drivers::Frameset& frameset);

  std::filesystem::path folder_;
  std::array<std::string, kCameraCount> indexes_;
  uint64_t count_ = 0;
  Status status_;
};

}  // namespace bevloc::evaluation
