#include "drivers/camera/libcamera/libcamera_camera.h"

#include <cstdlib>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "common/cameras.h"

namespace bevloc::drivers {
namespace {

/// libcamera ends the process if two of its managers exist at the same time.
TEST(LibcameraCamera, CamerasThatAreAbsentCanBeStartedAtTheSameTime) {
  setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);  // each manager logs its version
  MonotonicClock clock;
  std::vector<std::thread> threads;
  for (int index = 0; index < kCameraCount; ++index) {
    threads.emplace_back([index, &clock] {
      DeviceCameraConfig config;
      config.camera = index;
      config.id = "no such camera";
      LibcameraCamera camera(config, clock);
      for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(camera.start());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace bevloc::drivers
