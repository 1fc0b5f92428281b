#include "drivers/camera/mock_camera.h"

#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/drivers/mock_rig.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

/// The first `count` pictures of a camera.
std::vector<Pixels> pictures(const MockCameraConfig& config, int count) {
  VirtualClock clock;
  MockCamera camera(test_scene(), config, clock);
  EXPECT_TRUE(camera.start());
  std::vector<Pixels> taken;
  for (int i = 0; i < count; ++i) {
    Frame frame;
    EXPECT_EQ(camera.next_frame(milliseconds(1000), frame), FrameEvent::kFrame);
    const RgbView view = frame.pixels();
    taken.emplace_back(view.data, view.data + view.stride_bytes * view.height);
  }
  return taken;
}

TEST(MockCamera, SameSeedsGiveTheSamePictures) {
  EXPECT_EQ(pictures(small_front_camera(), 5), pictures(small_front_camera(), 5));
}

TEST(MockCamera, PicturesChangeFromFrameToFrameAndFromCameraToCamera) {
  const auto front = pictures(small_front_camera(), 2);
  EXPECT_NE(front[0], front[1]);
  MockCameraConfig other = small_front_camera();
  other.camera = 4;
  // The same view: only the pixel noise is another camera's.
  EXPECT_NE(pictures(other, 1)[0], front[0]);
}

TEST(MockCamera, ShowsSomething) {
  const Pixels picture = pictures(small_front_camera(), 1)[0];
  const auto [darkest, brightest] = std::minmax_element(picture.begin(), picture.end());
  EXPECT_GT(*brightest - *darkest, 50);
}

TEST(MockCamera, PictureDependsOnTimeNotOnWhenTheCameraStarted) {
  const MockCameraConfig config = small_front_camera();
  VirtualClock clock(Time(milliseconds(250)));
  MockCamera camera(test_scene(), config, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  ASSERT_EQ(camera.next_frame(milliseconds(1000), frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.time, Time(milliseconds(300)));
  const RgbView view = frame.pixels();
  EXPECT_EQ(Pixels(view.data, view.data + view.stride_bytes * view.height), pictures(config, 4)[3]);
}

TEST(MockCamera, FrozenPictureIsTheSameToThePixel) {
  MockCameraConfig config = small_front_camera();
  config.faults = {{CameraFaultKind::kFrozen, 0.15}};
  const auto taken = pictures(config, 5);
  EXPECT_NE(taken[1], taken[2]);
  EXPECT_EQ(taken[2], taken[3]);
  EXPECT_EQ(taken[3], taken[4]);
}

TEST(MockCamera, CamerasThatDrawAtOneTimeSeeWhatEachSeesAlone) {
  std::array<MockCameraConfig, kCameraCount> configs;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    configs[static_cast<size_t>(camera)] = small_front_camera();
    configs[static_cast<size_t>(camera)].camera = camera;
  }
  std::array<std::vector<Pixels>, kCameraCount> together;
  std::vector<std::thread> threads;
  for (size_t i = 0; i < configs.size(); ++i) {
    threads.emplace_back([&, i] { together[i] = pictures(configs[i], 8); });
  }
  for (std::thread& thread : threads) thread.join();
  for (size_t i = 0; i < configs.size(); ++i) {
    EXPECT_EQ(together[i], pictures(configs[i], 8)) << kCameraNames[i];
  }
}

TEST(MockCamera, DeadCameraIsSilentAndComesBack) {
  MockCameraConfig config = small_front_camera();
  config.faults = {{CameraFaultKind::kDead, 0.0, 20.0}};
  VirtualClock clock;
  MockCamera camera(test_scene(), config, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  for (int second = 0; second < 20; ++second) {
    EXPECT_EQ(camera.next_frame(milliseconds(1000), frame), FrameEvent::kTimeout);
  }
  EXPECT_EQ(camera.next_frame(milliseconds(100), frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.sequence, 200U);
}

TEST(MockCamera, CameraDeadForEverStaysSilent) {
  MockCameraConfig config = small_front_camera();
  config.faults = {{CameraFaultKind::kDead}};
  VirtualClock clock;
  MockCamera camera(test_scene(), config, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  EXPECT_EQ(camera.next_frame(std::chrono::hours(1), frame), FrameEvent::kTimeout);
  EXPECT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
}

}  // namespace
}  // namespace bevloc::drivers
