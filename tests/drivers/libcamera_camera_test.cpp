#include "drivers/camera/libcamera/libcamera_camera.h"

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "common/cameras.h"

namespace bevloc::drivers {
namespace {

DeviceCameraConfig absent_camera() {
  DeviceCameraConfig config;
  config.id = "no such camera";
  return config;
}

/// The numbers of the threads of this process.
std::set<std::string> thread_numbers() {
  std::set<std::string> numbers;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    numbers.insert(entry.path().filename().string());
  }
  return numbers;
}

/// The numbers in `after` that are not in `before`.
std::set<std::string> added(const std::set<std::string>& before,
                            const std::set<std::string>& after) {
  std::set<std::string> numbers = after;
  for (const std::string& number : before) numbers.erase(number);
  return numbers;
}

/// libcamera has a thread of its own while it runs.
TEST(LibcameraCamera, LibcameraKeepsRunningWhileACameraIsAbsent) {
  setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);
  MonotonicClock clock;
  const std::set<std::string> before = thread_numbers();
  LibcameraCamera camera(absent_camera(), clock);
  const Status started = camera.start();
  ASSERT_FALSE(started);
  if (started.error().message.find("cannot be started") != std::string::npos) {
    GTEST_SKIP() << "libcamera cannot run on this machine";
  }
  const std::set<std::string> first = added(before, thread_numbers());
  EXPECT_FALSE(first.empty());
  EXPECT_FALSE(camera.start());
  EXPECT_EQ(added(before, thread_numbers()), first);
}

TEST(LibcameraCamera, UsesAReadoutTime) {
  MonotonicClock clock;
  DeviceCameraConfig config = absent_camera();
  EXPECT_FALSE(LibcameraCamera(config, clock).description().ignores_readout);
  config.readout = std::chrono::milliseconds(20);
  EXPECT_FALSE(LibcameraCamera(config, clock).description().ignores_readout);
}

/// libcamera ends the process if two of its managers exist at the same time.
TEST(LibcameraCamera, CamerasThatAreAbsentCanBeStartedAtTheSameTime) {
  setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);  // each manager logs its version
  MonotonicClock clock;
  std::vector<std::thread> threads;
  for (int index = 0; index < kCameraCount; ++index) {
    threads.emplace_back([index, &clock] {
      DeviceCameraConfig config = absent_camera();
      config.camera = index;
      for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(LibcameraCamera(config, clock).start());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace bevloc::drivers
