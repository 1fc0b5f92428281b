// A drive in a folder of pictures: what the replay cameras play, with reference poses beside it.
#pragma once

#include <filesystem>
#include <memory>

#include "drivers/camera/replay/replay_camera.h"
#include "training/drives/recorded_drive.h"

namespace bevloc::drives {

/// The folder has CAMERA/frames.txt for each camera (drivers::load_recordings()) and reference.csv.
/// All times are of one clock.
class FolderDrive final : public RecordedDrive {
 public:
  static Result<std::unique_ptr<RecordedDrive>> open(const std::filesystem::path& folder,
                                                     const Rig& rig);

  Result<Time> read(const FramesetPlace& frameset, int camera, ImagePreprocessor& preprocessor,
                    std::span<int8_t> planes) override;

 private:
  FolderDrive(DriveIndex index, drivers::RecordedFrames frames)
      : RecordedDrive(std::move(index)), frames_(std::move(frames)) {}

  const drivers::RecordedFrames frames_;
  RgbImage image_;  ///< the latest one; keeps its memory
};

}  // namespace bevloc::drives
