// A camera on the vehicle whose image a renderer draws.
#pragma once

#include "pipeline/calibration/camera_model.h"

namespace bevloc::sim {

/// Refers to its camera models, which must outlive it.
struct MountedCamera {
  /// A camera that stays where it was built in.
  MountedCamera(const CameraModel& camera) : MountedCamera(camera, camera) {}
  MountedCamera(const CameraModel& now_camera, const CameraModel& built_in_camera)
      : now(now_camera), built_in(built_in_camera) {}

  const CameraModel& now;  ///< determines what the camera sees
  /// The camera before it was turned or moved. Its mounting determines the image sensor.
  const CameraModel& built_in;
};

}  // namespace bevloc::sim
