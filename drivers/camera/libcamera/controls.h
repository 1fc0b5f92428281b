// Exposure, gain, frame rate and the other controls of a libcamera camera.
#pragma once

#include <libcamera/libcamera.h>

#include "common/result.h"
#include "drivers/camera/device_camera.h"

namespace bevloc::drivers::libcam {

/// Returns the controls to set at the start: config.controls, by libcamera's names, and the frame
/// duration if the camera has this control. The error lists the controls or the range of values
/// that the camera has.
Result<libcamera::ControlList> start_controls(const libcamera::Camera& camera,
                                              const DeviceCameraConfig& config);

}  // namespace bevloc::drivers::libcam
