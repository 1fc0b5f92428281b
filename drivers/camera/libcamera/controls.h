// Exposure, gain, frame rate and the other controls of a libcamera camera.
#pragma once

#include <string_view>

#include <libcamera/libcamera.h>

#include "common/result.h"
#include "drivers/camera/device_camera.h"

namespace bevloc::drivers::libcam {

/// Whether the control with this name is a list of values in versions of libcamera that cannot tell
/// it (before 0.4).
bool is_known_list(std::string_view control);

/// Whether the value of the control is a list, such as ColourGains. libcamera ends the process if a
/// single number is set to it.
template <typename ControlId>
bool is_list(const ControlId& id) {
  if constexpr (requires { id.isArray(); }) {
    return id.isArray();
  } else {
    return is_known_list(id.name());
  }
}

/// Returns the controls to set at the start: config.controls, by libcamera's names, and the frame
/// duration if the camera has this control. A control that is a list is refused. The error lists
/// the controls or the range of values that the camera has.
Result<libcamera::ControlList> start_controls(const libcamera::Camera& camera,
                                              const DeviceCameraConfig& config);

}  // namespace bevloc::drivers::libcam
