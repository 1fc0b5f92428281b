// Exposure, gain, trigger mode and the other controls of a V4L2 device.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "drivers/camera/device_camera.h"
#include "drivers/camera/v4l2/device.h"

namespace bevloc::drivers::v4l2 {

/// As v4l2-ctl writes them: "Exposure Time, Absolute" is exposure_time_absolute.
std::string control_word(std::string_view name);

/// In the order given: automatic exposure must be off before an exposure time can be set. A control
/// is named as v4l2-ctl does or by its id (0x009a0902). Fails, with the controls or the range that
/// there are, for one that the device does not have or that refuses the value.
Status set_controls(const Device& device, std::span<const ControlSetting> settings);

}  // namespace bevloc::drivers::v4l2
