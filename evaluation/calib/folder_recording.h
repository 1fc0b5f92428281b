// A picture folder: what the replay cameras play, with reference poses beside it.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/cameras.h"
#include "drivers/camera/replay/recorded_framesets.h"
#include "pipeline/calibration/refine/picture_recording.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

class FolderRecording final : public PictureRecording {
 public:
  /// Reads the indexes: for each camera CAMERA/frames.txt (drivers::load_recording), and
  /// reference.csv. A camera without a folder is missing. Framesets (drivers::framesets_of) closer
  /// than `interval` to the one before are skipped. Fails if there is no camera, or if an index is
  /// wrong.
  static Result<std::unique_ptr<FolderRecording>> open(const std::filesystem::path& folder,
                                                       const Rig& rig, Duration interval);

  /// The cameras that have pictures in the folder.
  CameraMask cameras() const { return cameras_; }
  /// The files of the folder that are read.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  const ReferenceTrajectory& reference() const override { return reference_; }
  int framesets() const override { return static_cast<int>(framesets_.size()); }
  void rewind() override { next_ = 0; }
  /// The pictures are in the order of time.
  Status next(std::vector<RecordedPicture>& pictures) override;

 private:
  FolderRecording(const Rig& rig, ReferenceTrajectory reference, Duration interval,
                  drivers::RecordedFrames frames);

  const Rig rig_;
  const ReferenceTrajectory reference_;
  const drivers::RecordedFrames frames_;
  std::vector<std::filesystem::path> files_;
  CameraMask cameras_;
  std::vector<drivers::FramesetPlace> framesets_;
  size_t next_ = 0;
};

}  // namespace bevloc::evaluation
