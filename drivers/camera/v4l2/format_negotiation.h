// Negotiates pixel format, size and frame rate with a device.
#pragma once

#include "drivers/camera/device_camera.h"
#include "drivers/camera/v4l2/device.h"
#include "drivers/camera/v4l2/pixel_formats.h"

namespace bevloc::drivers::v4l2 {

struct StreamFormat {
  PixelFormat format = PixelFormat::kYuyv;
  v4l2_pix_format pixels{};
};

/// Sets the first of config.formats that the device supports at the configured size and rate. The
/// rate is not set on a device without rates, such as one with an external trigger. Refuses
/// interlaced video. The error lists what the device offers.
Result<StreamFormat> negotiate_format(const Device& device, const DeviceCameraConfig& config);

/// Fails if the device no longer has this format, because a control has changed it.
Status check_kept_format(const Device& device, const StreamFormat& format);

/// Lists all formats of the device: "YUYV 640x360 at 5, 10 Hz; MJPG 1280x720 at 30 Hz".
std::string offered_formats(const Device& device);

}  // namespace bevloc::drivers::v4l2
