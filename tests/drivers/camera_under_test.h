// The cameras on which the conformance suite runs.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/device_camera.h"
#include "drivers/clock/clock.h"

namespace bevloc::drivers {

struct CameraUnderTest {
  std::string name;
  bool is_device = false;  ///< a real camera: it has its own rate and uses the machine's clock
  std::function<std::unique_ptr<Camera>(Clock&, int buffers)> make;
};

inline void PrintTo(const CameraUnderTest& camera, std::ostream* stream) {
  *stream << camera.name;
}

/// The cameras of this machine. bevloc-compliance fills it in before GoogleTest starts.
struct CameraDevices {
  std::vector<std::string> v4l2;
  std::vector<std::string> v4l2_dmabuf;
  std::vector<std::string> libcamera;
  DeviceCameraConfig common;
  /// Shell commands that unplug and replug the camera under test. Empty if there are none.
  std::string unplug_command;
  std::string replug_command;
};
CameraDevices& camera_devices();

/// Returns the mock camera, the replay camera and the devices.
std::vector<CameraUnderTest> cameras_under_test();

}  // namespace bevloc::drivers
