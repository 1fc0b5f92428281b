// libcamera's names for pixel formats and colours, and its controls by name.
#pragma once

#include <span>

#include <libcamera/libcamera.h>

#include "common/image_view.h"
#include "common/result.h"
#include "drivers/camera/device_camera.h"

namespace bevloc::drivers::libcam {

struct StreamLayout {
  PixelFormat format = PixelFormat::kYuyv;
  int width_px = 0;
  int height_px = 0;
  std::ptrdiff_t stride_bytes = 0;
  YuvEncoding yuv;
};

/// Named as DRM does: its BGR888 has the bytes of our rgb24.
libcamera::PixelFormat libcamera_format(PixelFormat format);

/// BT.601, limited range, where libcamera does not know.
YuvEncoding yuv_encoding(const libcamera::StreamConfiguration& stream);

/// Puts the first of config.formats that the camera has at this size into `configuration`, with the
/// number of buffers. Fails, listing what the camera offers, when it has none.
Result<PixelFormat> choose_format(libcamera::CameraConfiguration& configuration,
                                  const DeviceCameraConfig& config);

/// The controls to start with: those configured, by libcamera's names, and the frame duration where
/// the camera knows it. Fails, with the controls or the range that there are.
Result<libcamera::ControlList> start_controls(const libcamera::Camera& camera,
                                              const DeviceCameraConfig& config);

}  // namespace bevloc::drivers::libcam
