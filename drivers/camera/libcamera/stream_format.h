// Negotiates pixel format and size with a libcamera camera.
#pragma once

#include <cstddef>

#include <libcamera/libcamera.h>

#include "common/image_view.h"
#include "common/result.h"
#include "drivers/camera/device_camera.h"

namespace bevloc::drivers::libcam {

/// The memory layout of the images of a stream.
struct StreamLayout {
  PixelFormat format = PixelFormat::kYuyv;
  int width_px = 0;
  int height_px = 0;
  std::ptrdiff_t stride_bytes = 0;
  YuvEncoding yuv;
};

/// Returns BT.601 with limited range if libcamera does not know the colour space.
YuvEncoding yuv_encoding(const libcamera::StreamConfiguration& stream);

/// Puts the first of config.formats that the camera supports at this size, and the number of
/// buffers, into `configuration`. The error lists what the camera offers.
Result<PixelFormat> choose_format(libcamera::CameraConfiguration& configuration,
                                  const DeviceCameraConfig& config);

}  // namespace bevloc::drivers::libcam
