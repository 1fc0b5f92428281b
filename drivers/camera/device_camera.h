// The configuration that V4L2 cameras and libcamera cameras share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/image_view.h"
#include "common/time.h"
#include "drivers/camera/camera.h"

namespace bevloc::drivers {

/// A control of the device that is set at each start: exposure, gain, trigger mode and so on.
struct ControlSetting {
  std::string name;
  double value = 0.0;
};

struct DeviceCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  std::string id;  ///< a stable name, not a number that depends on the order of detection
  int width_px = 0;
  int height_px = 0;
  std::vector<PixelFormat> formats;  ///< in order of preference; the device must have one of them
  double rate_hz = 0.0;              ///< 0 to set no rate, for example with an external trigger
  int buffers = kDefaultFrameBuffers;
  std::vector<ControlSetting> controls;
  Duration exposure{0};
  /// Time from the end of exposure of the first row to that of the last row. With V4L2, required
  /// for a device that stamps the end of the frame, and not used otherwise. libcamera does not tell
  /// what is stamped: if the time is given, it is used.
  std::optional<Duration> readout;
};

}  // namespace bevloc::drivers
