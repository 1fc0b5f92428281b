// Agrees with a device on pixel format, size and rate.
#pragma once

#include "drivers/camera/device_camera.h"
#include "drivers/camera/v4l2/device.h"
#include "drivers/camera/v4l2/pixel_formats.h"

namespace bevloc::drivers::v4l2 {

struct StreamFormat {
  PixelFormat format = PixelFormat::kYuyv;
  v4l2_pix_format pixels{};
};

/// Sets the first of config.formats that the device has at the size and rate wanted. A device that
/// knows no rates (its sensor is triggered from outside) is left alone with them. Fails, listing
/// what the device offers, when it has none.
Result<StreamFormat> negotiate_format(const Device& device, const DeviceCameraConfig& config);

/// "YUYV 640x360 at 5, 10 Hz; MJPG 1280x720 at 30 Hz": everything that the device has.
std::string offered_formats(const Device& device);

}  // namespace bevloc::drivers::v4l2
