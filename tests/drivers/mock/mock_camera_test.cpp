#include "drivers/mock/mock_camera.h"

#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/drivers/mock/mock_rig.h"

namespace bevloc::drivers {
namespace {

using sim::FaultKind;
using sim::make_fault;
using std::chrono::milliseconds;

std::shared_ptr<const sim::FaultBoard> faults(const std::vector<sim::Fault>& list) {
  return std::make_shared<const sim::FaultBoard>(list);
}

/// Captures the first `count` images of a camera.
std::vector<Pixels> first_images(const MockCameraConfig& config, int count) {
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

TEST(MockCamera, TheSameSeedsGiveTheSameImages) {
  EXPECT_EQ(first_images(small_front_camera(), 5), first_images(small_front_camera(), 5));
}

TEST(MockCamera, ImagesDifferBetweenFramesAndBetweenCameras) {
  const auto front = first_images(small_front_camera(), 2);
  EXPECT_NE(front[0], front[1]);
  MockCameraConfig other = small_front_camera();
  other.camera = 4;
  // The view is the same. Only the pixel noise differs.
  EXPECT_NE(first_images(other, 1)[0], front[0]);
}

TEST(MockCamera, ImagesHaveContrast) {
  const Pixels image = first_images(small_front_camera(), 1)[0];
  const auto [darkest, brightest] = std::minmax_element(image.begin(), image.end());
  EXPECT_GT(*brightest - *darkest, 50);
}

TEST(MockCamera, AnImageDependsOnItsTimeAndNotOnTheStart) {
  const MockCameraConfig config = small_front_camera();
  VirtualClock clock(Time(milliseconds(250)));
  MockCamera camera(test_scene(), config, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  ASSERT_EQ(camera.next_frame(milliseconds(1000), frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.time, Time(milliseconds(300)));
  const RgbView view = frame.pixels();
  EXPECT_EQ(Pixels(view.data, view.data + view.stride_bytes * view.height),
            first_images(config, 4)[3]);
}

TEST(MockCamera, AFrozenCameraRepeatsTheSamePixels) {
  MockCameraConfig config = small_front_camera();
  config.faults = faults({make_fault(FaultKind::kCameraFrozen, 0.15)});
  const auto taken = first_images(config, 5);
  EXPECT_NE(taken[1], taken[2]);
  EXPECT_EQ(taken[2], taken[3]);
  EXPECT_EQ(taken[3], taken[4]);
}

TEST(MockCamera, CamerasThatDrawAtTheSameTimeGiveTheSameImagesAsAlone) {
  std::array<MockCameraConfig, kCameraCount> configs;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    configs[static_cast<size_t>(camera)] = small_front_camera();
    configs[static_cast<size_t>(camera)].camera = camera;
  }
  std::array<std::vector<Pixels>, kCameraCount> together;
  std::vector<std::thread> threads;
  for (size_t i = 0; i < configs.size(); ++i) {
    threads.emplace_back([&, i] { together[i] = first_images(configs[i], 8); });
  }
  for (std::thread& thread : threads) thread.join();
  for (size_t i = 0; i < configs.size(); ++i) {
    EXPECT_EQ(together[i], first_images(configs[i], 8)) << kCameraNames[i];
  }
}

TEST(MockCamera, ADeadCameraIsSilentAndRecovers) {
  MockCameraConfig config = small_front_camera();
  config.faults = faults({make_fault(FaultKind::kCameraDead, 0.0, 20.0)});
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

TEST(MockCamera, ACameraThatStaysDeadIsSilent) {
  MockCameraConfig config = small_front_camera();
  config.faults = faults({make_fault(FaultKind::kCameraDead)});
  VirtualClock clock;
  MockCamera camera(test_scene(), config, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  EXPECT_EQ(camera.next_frame(std::chrono::hours(1), frame), FrameEvent::kTimeout);
  EXPECT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
}

}  // namespace
}  // namespace bevloc::drivers
