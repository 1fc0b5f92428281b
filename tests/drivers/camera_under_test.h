// The cameras that the conformance suite is run on.
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
  bool is_device = false;  ///< runs on the machine's clock, at its own pace
  std::function<std::unique_ptr<Camera>(Clock&, int buffers)> make;
};

inline void PrintTo(const CameraUnderTest& camera, std::ostream* stream) {
  *stream << camera.name;
}

/// Devices of this machine; bevloc-compliance fills it in before GoogleTest starts.
struct CameraDevices {
  std::vector<std::string> v4l2;
  std::vector<std::string> v4l2_dmabuf;
  std::vector<std::string> libcamera;
  DeviceCameraConfig common;
  /// Shell commands that pull and plug the cable of the camera under test; empty when nobody can.
  std::string unplug_command;
  std::string replug_command;
};
CameraDevices& camera_devices();

/// Mock, replay, and the devices.
std::vector<CameraUnderTest> cameras_under_test();

}  // namespace bevloc::drivers
