// The pictures of a drive and its reference poses, from a picture folder or a simulated drive.
#pragma once

#include <vector>

#include "common/result.h"
#include "common/time.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "pipeline/calibration/refine/grey_image.h"

namespace bevloc {

struct RecordedPicture {
  int camera = 0;  ///< index into kCameraNames
  Time time;       ///< time stamp in the recording
  GreyImage image;
};

/// Each kind of recording implements this. Reading goes from the first frameset to the last, and
/// may start again. One thread.
class PictureRecording {
 public:
  virtual ~PictureRecording() = default;

  virtual const ReferenceTrajectory& reference() const = 0;
  virtual int framesets() const = 0;
  virtual void rewind() = 0;
  /// Replaces `pictures` by those of the next frameset, at most one of each camera. At the end
  /// there are none. The times of pictures and reference are on the same clock.
  virtual Status next(std::vector<RecordedPicture>& pictures) = 0;
};

}  // namespace bevloc
