// The keys of the section `cameras` for V4L2 and libcamera cameras.
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

/// How the buffers of a V4L2 camera are accessed.
enum class CameraMemory : uint8_t { kMmap, kDmabuf };

/// The settings of all six cameras. The image size comes from the calibration.
struct CameraDevicesConfig {
  std::array<std::string, kCameraCount> ids;  ///< in the order of kCameraNames
  /// In order of preference.
  std::vector<PixelFormat> formats{PixelFormat::kNv12, PixelFormat::kYuyv, PixelFormat::kUyvy};
  double rate_hz = 0.0;  ///< 0 for the rate of the device or of its trigger
  CameraMemory memory = CameraMemory::kMmap;
  std::vector<drivers::ControlSetting> controls;  ///< set in this order at each start
  Duration exposure{0};                           ///< the exposure time that `controls` sets
  /// Time from the end of exposure of the first row to that of the last row.
  std::optional<Duration> readout;
};

/// Reads the keys. YamlMap::finish() reports mistakes.
CameraDevicesConfig read_camera_devices(YamlMap& cameras);

/// Returns the driver's configuration of one camera.
drivers::DeviceCameraConfig device_camera(const CameraDevicesConfig& config, int buffers,
                                          const Rig& rig, int camera);

}  // namespace bevloc::firmware
