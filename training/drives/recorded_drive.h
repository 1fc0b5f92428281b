// A recorded drive with reference poses: the framesets from which training samples are made.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/result.h"
#include "common/time.h"
#include "drivers/camera/replay/recorded_framesets.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/preprocessing/image_remap.h"

namespace bevloc::drives {

using drivers::FramesetPlace;
using drivers::kWidestSpread;

/// What is known of a drive before an image is read.
struct DriveIndex {
  std::string name;  ///< for messages
  Rig rig;           ///< of the cameras that took the images
  ReferenceTrajectory reference;
  std::vector<FramesetPlace> framesets;  ///< in the order of time
};

/// A drive in files. One thread.
class RecordedDrive {
 public:
  explicit RecordedDrive(DriveIndex index) : index_(std::move(index)) {}
  virtual ~RecordedDrive() = default;
  RecordedDrive(const RecordedDrive&) = delete;
  RecordedDrive& operator=(const RecordedDrive&) = delete;

  const DriveIndex& index() const { return index_; }

  /// Reads the camera's frame of a frameset that has one. Writes the network's image
  /// (ImagePreprocessor::run) and returns when the exposure started. Fails if the image is missing,
  /// damaged or of another size than the rig states.
  virtual Result<Time> read(const FramesetPlace& frameset, int camera,
                            ImagePreprocessor& preprocessor, std::span<int8_t> planes) = 0;

 private:
  const DriveIndex index_;
};

}  // namespace bevloc::drives
