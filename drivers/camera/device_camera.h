// What is configured about a camera that is a device, whichever system it is reached through.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/image_view.h"
#include "common/time.h"

namespace bevloc::drivers {

/// A control of the device, set at each start: exposure, gain, trigger mode and whatever it has.
struct ControlSetting {
  std::string name;
  double value = 0.0;
};

struct DeviceCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  std::string id;  ///< stable: never a number that depends on the order of detection
  int width_px = 0;
  int height_px = 0;
  std::vector<PixelFormat> formats;  ///< the first that the device has at this size is taken
  double rate_hz = 0.0;              ///< 0 leaves it to the device, as with an external trigger
  int buffers = 4;
  std::vector<ControlSetting> controls;
  Duration exposure{0};
  /// From the first row's end of exposure to the last row's. Devices that stamp the end of a frame
  /// need it.
  std::optional<Duration> readout;
};

}  // namespace bevloc::drivers
