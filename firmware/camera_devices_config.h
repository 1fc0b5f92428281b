// What the section `cameras` of the configuration file says about cameras that are devices.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/image_view.h"
#include "common/strict_yaml.h"
#include "common/time.h"
#include "drivers/camera/device_camera.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::firmware {

/// How a V4L2 camera's memory is reached.
enum class CameraMemory : uint8_t { kMmap, kDmabuf };

/// Of all six cameras; their size comes from the calibration.
struct CameraDevicesConfig {
  std::array<std::string, kCameraCount> ids;
  std::vector<PixelFormat> formats;
  double rate_hz = 0.0;  ///< 0: what the device does by itself, or its trigger
  CameraMemory memory = CameraMemory::kMmap;
  std::vector<drivers::ControlSetting> controls;
  Duration exposure{0};
  std::optional<Duration> readout;
};

/// Mistakes are reported by the file's YamlMap::finish().
CameraDevicesConfig read_camera_devices(YamlMap& cameras);

/// As the drivers want it.
drivers::DeviceCameraConfig device_camera(const CameraDevicesConfig& config, int buffers,
                                          const Rig& rig, int camera);

}  // namespace bevloc::firmware
