// Exposure, gain, trigger mode and the other controls of a V4L2 device.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "drivers/camera/device_camera.h"
#include "drivers/camera/v4l2/device.h"

namespace bevloc::drivers::v4l2 {

/// Converts the name of a control to the form of v4l2-ctl: "Exposure Time, Absolute" becomes
/// exposure_time_absolute.
std::string control_word(std::string_view name);

/// Sets the controls in the given order, because for example automatic exposure must be off before
/// an exposure time can be set. A control is given by its name as v4l2-ctl shows it, or by its id
/// (0x009a0902). Sets only the controls that have all of `flags` (V4L2_CTRL_FLAG_*). The error
/// lists the controls or the range of values that the device has.
Status set_controls(const Device& device, std::span<const ControlSetting> settings,
                    uint32_t flags = 0);

}  // namespace bevloc::drivers::v4l2
