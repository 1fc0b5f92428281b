#include "drivers/mock/mock_camera.h"

#include <algorithm>
#include <array>
#include <numeric>
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

MockCameraConfig camera_with(int camera, sim::Fault fault) {
  MockCameraConfig config = small_front_camera();
  config.camera = camera;
  // Each camera looks in its own direction.
  for (int i = 0; i < kCameraCount; ++i) {
    config.true_rig.cameras[i].vehicle_from_camera =
        sim::nominal_rig().cameras[i].vehicle_from_camera;
  }
  config.faults = faults({fault});
  return config;
}

double mean(const Pixels& pixels) {
  return std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
}

const sim::Fault kNoFault = make_fault(FaultKind::kGnssOutage);

TEST(MockCamera, SwappedCamerasShowEachOthersPictures) {
  sim::Fault swapped = make_fault(FaultKind::kCameraSwapped, 0.2);
  swapped.camera = 1;
  swapped.other_camera = 4;
  const auto front = first_images(camera_with(1, kNoFault), 4);
  const auto back = first_images(camera_with(4, kNoFault), 4);
  const auto swapped_front = first_images(camera_with(1, swapped), 4);
  const auto swapped_back = first_images(camera_with(4, swapped), 4);
  EXPECT_EQ(swapped_front[1], front[1]);
  for (size_t i = 2; i < 4; ++i) {
    EXPECT_EQ(swapped_front[i], back[i]);
    EXPECT_EQ(swapped_back[i], front[i]);
  }
}

TEST(MockCamera, DarkBlindedDirtyTurnedAndMovedPicturesDifferOnlyDuringTheFault) {
  const auto good = first_images(camera_with(1, kNoFault), 4);
  for (const FaultKind kind :
       {FaultKind::kCameraDark, FaultKind::kCameraBlinded, FaultKind::kCameraDirty,
        FaultKind::kCameraTurned, FaultKind::kCameraMoved}) {
    sim::Fault fault = make_fault(kind, 0.1, 0.3);
    fault.amounts.yaw_deg = 5.0;
    fault.amounts.y_m = 1.0;
    const auto bad = first_images(camera_with(1, fault), 4);
    EXPECT_EQ(bad[0], good[0]) << info_of(kind).name;
    EXPECT_NE(bad[1], good[1]) << info_of(kind).name;
    EXPECT_NE(bad[2], good[2]) << info_of(kind).name;
    EXPECT_NE(bad[1], bad[2]) << info_of(kind).name << ": the picture still changes";
    EXPECT_EQ(bad[3], good[3]) << info_of(kind).name;
    const double level = mean(bad[1]);
    EXPECT_EQ(level < 3.0, kind == FaultKind::kCameraDark) << level;
    EXPECT_EQ(level > 240.0, kind == FaultKind::kCameraBlinded) << level;
  }
}

TEST(MockCamera, ATurnedOrMovedCameraKeepsItsImageSensor) {
  const auto good = first_images(camera_with(1, kNoFault), 2);
  for (const FaultKind kind : {FaultKind::kCameraTurned, FaultKind::kCameraMoved}) {
    sim::Fault hardly = make_fault(kind, 0.1);
    hardly.amounts.yaw_deg = 1e-9;
    hardly.amounts.y_m = 1e-12;
    EXPECT_EQ(first_images(camera_with(1, hardly), 2)[1], good[1]) << info_of(kind).name;
  }
}

TEST(MockCamera, DirtAndNoiseOfAFaultDependOnItsSeed) {
  for (const FaultKind kind :
       {FaultKind::kCameraDark, FaultKind::kCameraBlinded, FaultKind::kCameraDirty}) {
    MockCameraConfig config = camera_with(1, make_fault(kind, 0.1));
    const auto first = first_images(config, 2);
    config.fault_seed = 1;
    const auto second = first_images(config, 2);
    EXPECT_EQ(first[0], second[0]) << info_of(kind).name << ": before the fault";
    EXPECT_NE(first[1], second[1]) << info_of(kind).name;
  }
}

TEST(MockCamera, ALoopShowsTheSamePixelsAgain) {
  sim::Fault loop = make_fault(FaultKind::kCameraLoop, 0.1);
  loop.amounts.pictures = 2;
  const auto taken = first_images(camera_with(1, loop), 5);
  EXPECT_EQ(taken[1], taken[3]);
  EXPECT_EQ(taken[2], taken[4]);
  EXPECT_NE(taken[1], taken[2]);
}

TEST(MockCamera, AfterASuspensionTheDriveHasGoneOn) {
  sim::Fault suspend = make_fault(FaultKind::kClockSuspend, 0.2);
  suspend.amounts.gap_s = 0.2;
  const auto good = first_images(camera_with(1, kNoFault), 6);
  const auto suspended = first_images(camera_with(1, suspend), 4);
  EXPECT_EQ(suspended[1], good[1]);
  EXPECT_EQ(suspended[2], good[4]);
  EXPECT_EQ(suspended[3], good[5]);
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
