// Tests the configuration of real cameras, and the factory that makes them.
#include "firmware/config/camera_devices_config.h"

#include <gtest/gtest.h>

#include "firmware/devices/camera_factory.h"

namespace bevloc::firmware {
namespace {

const std::string kIds =
    "ids: {front_left: c0, front: c1, front_right: c2, back_left: c3, back: c4, back_right: c5}\n";

/// The error message for this text; empty without an error.
std::string error_of(const std::string& text) {
  auto yaml = YamlMap::parse(text, "test");
  if (!yaml) return yaml.error().message;
  read_camera_devices(*yaml);
  const Status finished = yaml->finish();
  return finished ? "" : finished.error().message;
}

CameraDevicesConfig read_devices(const std::string& text) {
  auto yaml = YamlMap::parse(text, "test");
  EXPECT_TRUE(yaml);
  const CameraDevicesConfig config = read_camera_devices(*yaml);
  const Status finished = yaml->finish();
  EXPECT_TRUE(finished) << finished.error().message;
  return config;
}

TEST(CameraDevicesConfig, NeedsOnlyTheIds) {
  const CameraDevicesConfig config = read_devices(kIds);
  EXPECT_EQ(config.ids[0], "c0");
  EXPECT_EQ(config.ids[5], "c5");
  EXPECT_EQ(config.formats.front(), PixelFormat::kNv12);
  EXPECT_EQ(config.rate_hz, 0.0);
  EXPECT_EQ(config.memory, CameraMemory::kMmap);
  EXPECT_FALSE(config.readout);
}

TEST(CameraDevicesConfig, EveryKeyReachesTheDriver) {
  const CameraDevicesConfig config = read_devices(
      kIds +
      "formats: [mjpeg, bayer_grbg]\nrate_hz: 12.5\nmemory: dmabuf\nexposure_ms: 8\n"
      "readout_ms: 20\ncontrols: [{name: auto_exposure, value: 1}, {name: AnalogueGain, "
      "value: 2.5}]");
  EXPECT_EQ(config.memory, CameraMemory::kDmabuf);
  Rig rig;
  rig.cameras[4].intrinsics.width_px = 640;
  rig.cameras[4].intrinsics.height_px = 360;
  const drivers::DeviceCameraConfig device = device_camera(config, 7, rig, 4);
  EXPECT_EQ(device.camera, 4);
  EXPECT_EQ(device.id, "c4");
  EXPECT_EQ(device.width_px, 640);
  EXPECT_EQ(device.height_px, 360);
  EXPECT_EQ(device.formats, (std::vector{PixelFormat::kMjpeg, PixelFormat::kBayerGrbg}));
  EXPECT_EQ(device.rate_hz, 12.5);
  EXPECT_EQ(device.buffers, 7);
  ASSERT_EQ(device.controls.size(), 2U);
  EXPECT_EQ(device.controls[1].name, "AnalogueGain");
  EXPECT_EQ(device.controls[1].value, 2.5);
  EXPECT_EQ(device.exposure, std::chrono::milliseconds(8));
  EXPECT_EQ(device.readout, std::chrono::milliseconds(20));
}

TEST(CameraDevicesConfig, NamesTheKeyOfEachMistake) {
  EXPECT_NE(error_of("ids: {front_left: c0}\n").find("ids.front"), std::string::npos);
  std::string text = kIds;
  EXPECT_NE(error_of(text.replace(text.find("c3"), 2, "c1")).find("ids.back_left"),
            std::string::npos)
      << "two cameras with the same id";
  text = kIds;
  EXPECT_NE(error_of(text.replace(text.find("c3"), 2, "/dev/video3")).find("ids.back_left"),
            std::string::npos);
  EXPECT_NE(error_of(kIds + "formats: [yuv]\n").find("formats"), std::string::npos);
  EXPECT_NE(error_of(kIds + "formats: []\n").find("formats"), std::string::npos);
  EXPECT_NE(error_of(kIds + "controls: [{name: gain}]\n").find("value"), std::string::npos);
}

TEST(CameraFactory, NamesTheMissingCamera) {
  CameraConfig config;
  config.driver = CameraDriver::kV4l2;
  config.devices.ids.fill("no-such-camera");
  const Status status = check_cameras(config, Rig{});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("camera front_left"), std::string::npos);
  EXPECT_NE(status.error().message.find("no-such-camera"), std::string::npos);
}

TEST(CameraFactory, MakesCamerasThatAreNotConnectedYet) {
  CameraConfig config;
  config.driver = CameraDriver::kV4l2;
  config.devices.ids.fill("no-such-camera");
  drivers::MonotonicClock clock;
  auto cameras = make_cameras(config, Rig{}, clock);
  ASSERT_TRUE(cameras);
  ASSERT_EQ(cameras->size(), static_cast<size_t>(kCameraCount));
  const Status started = cameras->front()->start();
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().message.find("no-such-camera"), std::string::npos);
}

}  // namespace
}  // namespace bevloc::firmware
