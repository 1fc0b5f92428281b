// What every camera must do, mock or real: one suite for all implementations.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/camera/camera.h"
#include "drivers/camera/replay_camera.h"
#include "tests/drivers/mock_rig.h"
#include "tests/drivers/recording.h"

namespace bevloc::drivers {
namespace {

/// Far longer than any camera needs for one frame.
constexpr Duration kPatience = std::chrono::seconds(2);

struct CameraMaker {
  std::string name;
  std::function<std::unique_ptr<Camera>(Clock&)> make;
};

std::unique_ptr<Camera> make_mock_camera(Clock& clock) {
  return std::make_unique<MockCamera>(test_scene(), small_front_camera(), clock);
}

std::unique_ptr<Camera> make_replay_camera(Clock& clock) {
  static const Recording recording;
  static const bool is_written = [] {
    std::string index;
    for (int k = 0; k < 120; ++k) {
      const std::string name = std::to_string(k) + ".png";
      recording.add_picture(name, 8, 6, {static_cast<uint8_t>(k), 100, 200});
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
  return std::make_unique<ReplayCamera>(config, clock);
}

int open_descriptors() {
  int count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    ++count;
  }
  return count;
}

std::vector<uint8_t> copy_pixels(const Frame& frame) {
  const RgbView view = frame.pixels();
  std::vector<uint8_t> pixels;
  for (int v = 0; v < view.height; ++v) {
    pixels.insert(pixels.end(), view.row(v), view.row(v) + 3 * view.width);
  }
  return pixels;
}

class CameraConformance : public testing::TestWithParam<CameraMaker> {
 protected:
  /// The next frame, which must come.
  Frame capture() {
    Frame frame;
    const auto event = camera_->next_frame(kPatience, frame);
    EXPECT_TRUE(event) << event.error().message;
    EXPECT_EQ(event, FrameEvent::kFrame);
    return frame;
  }

  /// Captures `count` frames, one at a time, and checks what must hold for each.
  void capture_in_order(int count) {
    const CameraDescription description = camera_->description();
    for (int i = 0; i < count; ++i) {
      const Frame frame = capture();
      ASSERT_TRUE(frame.buffer);
      EXPECT_EQ(frame.camera, description.camera);
      EXPECT_EQ(frame.pixels().width, description.width_px);
      EXPECT_EQ(frame.pixels().height, description.height_px);
      EXPECT_EQ(frame.sequence, static_cast<uint64_t>(i));
      EXPECT_GT(frame.time, latest_time_);
      EXPECT_LE(frame.time, clock_.now());
      latest_time_ = frame.time;
    }
  }

  VirtualClock clock_;
  std::unique_ptr<Camera> camera_ = GetParam().make(clock_);
  Time latest_time_ = Time::min();
};

TEST_P(CameraConformance, DescribesItself) {
  const CameraDescription description = camera_->description();
  EXPECT_GE(description.camera, 0);
  EXPECT_LT(description.camera, kCameraCount);
  EXPECT_GT(description.width_px, 0);
  EXPECT_GT(description.height_px, 0);
  EXPECT_GE(description.buffers, 2);
}

TEST_P(CameraConformance, GivesNothingUnlessStarted) {
  Frame frame;
  EXPECT_FALSE(camera_->next_frame(kPatience, frame));
  camera_->stop();
  ASSERT_TRUE(camera_->start());
  EXPECT_FALSE(camera_->start()) << "a second start must be refused";
  capture_in_order(1);
  camera_->stop();
  camera_->stop();
  EXPECT_FALSE(camera_->next_frame(kPatience, frame));
}

TEST_P(CameraConformance, GivesAsManyFramesAsAreAskedFor) {
  for (const int count : {1, 2, 3, 5, 8, 89}) {
    SCOPED_TRACE(count);
    clock_ = VirtualClock();
    latest_time_ = Time::min();
    camera_ = GetParam().make(clock_);
    ASSERT_TRUE(camera_->start());
    capture_in_order(count);
    camera_->stop();
    EXPECT_EQ(camera_->counters().delivered, static_cast<uint64_t>(count));
    EXPECT_EQ(camera_->counters().no_buffer, 0U);
    EXPECT_EQ(camera_->counters().overrun, 0U);
  }
}

TEST_P(CameraConformance, StartsAgainAfterEachStop) {
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(camera_->start());
    capture_in_order(4);
    camera_->stop();
    clock_.advance(std::chrono::milliseconds(130));
  }
}

TEST_P(CameraConformance, FramesHeldAcrossAStopStayAsTheyAre) {
  ASSERT_TRUE(camera_->start());
  const Frame first = capture();
  const Frame second = capture();
  const auto first_pixels = copy_pixels(first);
  const auto second_pixels = copy_pixels(second);
  camera_->stop();
  EXPECT_EQ(copy_pixels(first), first_pixels);
  ASSERT_TRUE(camera_->start());
  for (int i = 0; i < 5; ++i) capture();
  EXPECT_EQ(copy_pixels(first), first_pixels);
  EXPECT_EQ(copy_pixels(second), second_pixels);
  camera_.reset();
  EXPECT_EQ(copy_pixels(second), second_pixels);
}

TEST_P(CameraConformance, AllBuffersCanBeHeldAndComeBack) {
  ASSERT_TRUE(camera_->start());
  for (int round = 0; round < 3; ++round) {
    std::vector<Frame> held;
    for (int i = 0; i < camera_->description().buffers; ++i) held.push_back(capture());
    const uint64_t lost_before = camera_->counters().no_buffer;
    Frame frame;
    EXPECT_EQ(camera_->next_frame(std::chrono::milliseconds(500), frame), FrameEvent::kTimeout);
    EXPECT_GT(camera_->counters().no_buffer, lost_before);
    const uint64_t newest = held.back().sequence;
    held.clear();
    EXPECT_GT(capture().sequence, newest + 1) << "the lost frames must show as a gap";
  }
}

TEST_P(CameraConformance, AFrameCanBeDroppedByAnotherThread) {
  ASSERT_TRUE(camera_->start());
  for (int i = 0; i < 3 * camera_->description().buffers; ++i) {
    std::thread([frame = capture()] { EXPECT_TRUE(frame.buffer); }).join();
  }
  EXPECT_EQ(camera_->counters().no_buffer, 0U);
}

TEST_P(CameraConformance, ALookThatFindsNothingLeavesTheFrameAlone) {
  ASSERT_TRUE(camera_->start());
  Frame frame = capture();
  const Time time = frame.time;
  EXPECT_EQ(camera_->next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
  EXPECT_TRUE(frame.buffer);
  EXPECT_EQ(frame.time, time);
}

TEST_P(CameraConformance, LeaksNoDescriptor) {
  const auto use_once = [this] {
    ASSERT_TRUE(camera_->start());
    capture_in_order(2);
    camera_->stop();
    clock_.advance(std::chrono::milliseconds(130));
  };
  use_once();
  const int before = open_descriptors();
  for (int i = 0; i < 10; ++i) use_once();
  EXPECT_EQ(open_descriptors(), before);
}

INSTANTIATE_TEST_SUITE_P(Cameras, CameraConformance,
                         testing::Values(CameraMaker{"mock", make_mock_camera},
                                         CameraMaker{"replay", make_replay_camera}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace bevloc::drivers
