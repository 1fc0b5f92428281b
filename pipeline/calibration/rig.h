// The rig: intrinsics and extrinsics of the six cameras.
#pragma once

#include <array>

#include "common/cameras.h"
#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc {

struct Rig {
  std::array<CameraModel, kCameraCount> cameras;  ///< in the order of kCameraNames
};

/// reference_from_exposure of each camera: the vehicle's pose at the exposure, in the vehicle frame
/// at the reference time of the frameset. All zero if the cameras expose at the same time.
using CameraMotions = std::array<Se2, kCameraCount>;

}  // namespace bevloc
