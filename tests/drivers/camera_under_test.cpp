#include "tests/drivers/camera_under_test.h"

#include <gtest/gtest.h>

#include "drivers/camera/replay/replay_camera.h"
#include "drivers/camera/v4l2/v4l2_camera.h"
#include "tests/drivers/mock/mock_rig.h"
#include "tests/drivers/recording.h"
#ifdef BEVLOC_HAS_LIBCAMERA
#include "drivers/camera/libcamera/libcamera_camera.h"
#endif

namespace bevloc::drivers {
namespace {

std::unique_ptr<Camera> make_mock_camera(Clock& clock, int buffers) {
  MockCameraConfig config = small_front_camera();
  config.buffers = buffers;
  return std::make_unique<MockCamera>(test_scene(), config, clock);
}

std::unique_ptr<Camera> make_replay_camera(Clock& clock, int buffers) {
  static const Recording recording;
  static const bool is_written = [] {
    std::string index;
    for (int k = 0; k < 120; ++k) {
      const std::string name = std::to_string(k) + ".png";
      recording.add_image(name, 8, 6, {static_cast<uint8_t>(k), 100, 200});
      index += fmt::format("{} {} {}\n", k, 100'000'000LL * k, name);
    }
    recording.write("frames.txt", index);
    return true;
  }();
  EXPECT_TRUE(is_written);
  ReplayCameraConfig config;
  config.camera = 1;
  config.directory = recording.directory();
  config.width_px = 8;
  config.height_px = 6;
  config.readout = std::chrono::milliseconds(20);
  config.buffers = buffers;
  return std::make_unique<ReplayCamera>(config, clock);
}

DeviceCameraConfig device_config(const std::string& id, int buffers) {
  DeviceCameraConfig config = camera_devices().common;
  config.id = id;
  config.buffers = buffers;
  return config;
}

CameraUnderTest v4l2_camera(const std::string& id, v4l2::MemoryAccess memory) {
  const bool is_dmabuf = memory == v4l2::MemoryAccess::kDmabuf;
  return {fmt::format("v4l2{}:{}", is_dmabuf ? "-dmabuf" : "", id), true,
          [=](Clock& clock, int buffers) {
            return std::make_unique<V4l2Camera>(
                V4l2CameraConfig{device_config(id, buffers), memory}, clock);
          }};
}

}  // namespace

CameraDevices& camera_devices() {
  static CameraDevices devices;
  return devices;
}

std::vector<CameraUnderTest> cameras_under_test() {
  std::vector<CameraUnderTest> cameras = {{"mock", false, make_mock_camera},
                                          {"replay", false, make_replay_camera}};
  const CameraDevices& devices = camera_devices();
  for (const std::string& id : devices.v4l2) {
    cameras.push_back(v4l2_camera(id, v4l2::MemoryAccess::kMapped));
  }
  for (const std::string& id : devices.v4l2_dmabuf) {
    cameras.push_back(v4l2_camera(id, v4l2::MemoryAccess::kDmabuf));
  }
#ifdef BEVLOC_HAS_LIBCAMERA
  for (const std::string& id : devices.libcamera) {
    cameras.push_back({"libcamera:" + id, true, [id](Clock& clock, int buffers) {
                         return std::make_unique<LibcameraCamera>(device_config(id, buffers),
                                                                  clock);
                       }});
  }
#endif
  return cameras;
}

}  // namespace bevloc::drivers
