// The conformance suite of Camera: every implementation must pass it, mock or real.
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/drivers/camera_under_test.h"
#include "tests/support/open_descriptors.h"

namespace bevloc::drivers {
namespace {

using test::open_descriptors;

constexpr int kBuffers = 4;

/// Copies the bytes of the image's first plane, with padding.
std::vector<uint8_t> copy_bytes(const Frame& frame) {
  const ImageView& view = frame.image();
  const size_t size = view.format == PixelFormat::kMjpeg
                          ? view.bytes_used
                          : static_cast<size_t>(view.planes[0].stride_bytes) * view.height;
  return {view.planes[0].data, view.planes[0].data + size};
}

class CameraConformance : public testing::TestWithParam<CameraUnderTest> {
 protected:
  Clock& clock() {
    if (GetParam().is_device) return machine_clock_;
    return virtual_clock_;
  }

  /// A time in which any camera delivers many frames.
  Duration timeout() const { return std::chrono::seconds(GetParam().is_device ? 20 : 2); }

  /// A time of several frame periods.
  Duration several_frames() const {
    return std::chrono::milliseconds(GetParam().is_device ? 2500 : 500);
  }

  void pause(Duration duration) { clock().sleep_until(clock().now() + duration); }

  void make(int buffers) {
    camera_.reset();
    latest_time_ = Time::min();
    camera_ = GetParam().make(clock(), buffers);
  }

  void start() {
    const Status started = camera_->start();
    ASSERT_TRUE(started) << started.error().message;
  }

  /// Returns the next frame, which must arrive in time.
  Frame capture() {
    Frame frame;
    const auto event = camera_->next_frame(timeout(), frame);
    EXPECT_TRUE(event) << event.error().message;
    EXPECT_EQ(event, FrameEvent::kFrame);
    return frame;
  }

  /// Captures `count` frames one after the other and checks each. Only a device may lose frames
  /// before the driver.
  void capture_in_order(int count) {
    const CameraDescription description = camera_->description();
    uint64_t expected = 0;
    for (int i = 0; i < count; ++i) {
      const Frame frame = capture();
      ASSERT_TRUE(frame.buffer);
      EXPECT_EQ(frame.camera, description.camera);
      EXPECT_EQ(frame.image().width, description.width_px);
      EXPECT_EQ(frame.image().height, description.height_px);
      EXPECT_GE(frame.sequence, expected);
      if (!GetParam().is_device) {
        EXPECT_EQ(frame.sequence, expected);
      }
      expected = frame.sequence + 1;
      EXPECT_GT(frame.time, latest_time_);
      EXPECT_LE(frame.time, clock().now());
      EXPECT_GE(frame.time, clock().now() - timeout());
      latest_time_ = frame.time;
    }
  }

  /// Calls start() until it succeeds, because a device that was plugged in appears only after a
  /// while.
  bool starts_within(Duration limit) {
    const Time give_up = clock().now() + limit;
    while (clock().now() < give_up) {
      if (camera_->start()) return true;
      pause(std::chrono::milliseconds(200));
    }
    return false;
  }

  VirtualClock virtual_clock_;
  MonotonicClock machine_clock_;
  std::unique_ptr<Camera> camera_ = GetParam().make(clock(), kBuffers);
  Time latest_time_ = Time::min();
};

TEST_P(CameraConformance, DescribesItself) {
  const CameraDescription description = camera_->description();
  EXPECT_GE(description.camera, 0);
  EXPECT_LT(description.camera, 6);
  EXPECT_GT(description.width_px, 0);
  EXPECT_GT(description.height_px, 0);
  EXPECT_GE(description.buffers, 2);
}

TEST_P(CameraConformance, DeliversNothingUnlessStarted) {
  Frame frame;
  EXPECT_FALSE(camera_->next_frame(timeout(), frame));
  camera_->stop();
  start();
  EXPECT_FALSE(camera_->start()) << "a second start must be refused";
  capture_in_order(1);
  camera_->stop();
  camera_->stop();
  EXPECT_FALSE(camera_->next_frame(timeout(), frame));
}

TEST_P(CameraConformance, DeliversAnyNumberOfFrames) {
  for (const int count : {1, 2, 3, 5, 8, 89}) {
    SCOPED_TRACE(count);
    if (!GetParam().is_device) virtual_clock_ = VirtualClock();
    make(kBuffers);
    start();
    capture_in_order(count);
    camera_->stop();
    EXPECT_EQ(camera_->counters().delivered, static_cast<uint64_t>(count));
    EXPECT_EQ(camera_->counters().no_buffer, 0U);
    EXPECT_EQ(camera_->counters().overrun, 0U);
    EXPECT_EQ(camera_->counters().damaged, 0U);
  }
}

/// A device may allocate another number of buffers. Then it must report that number, or refuse to
/// start with a message.
TEST_P(CameraConformance, WorksWithAnyNumberOfBuffers) {
  for (const int buffers : {1, 2, 3, 5, 8, 89}) {
    SCOPED_TRACE(buffers);
    if (!GetParam().is_device && buffers > 64) continue;  // the limit of FramePool
    if (!GetParam().is_device) virtual_clock_ = VirtualClock();
    make(buffers);
    if (const Status started = camera_->start(); !started) {
      EXPECT_TRUE(GetParam().is_device);
      EXPECT_FALSE(started.error().message.empty());
      std::printf("%d buffers: refused: %s\n", buffers, started.error().message.c_str());
      continue;
    }
    const int allocated = camera_->description().buffers;
    EXPECT_GE(allocated, 1);
    if (allocated != buffers) std::printf("%d buffers: %d allocated\n", buffers, allocated);
    capture_in_order(4);
    camera_->stop();
  }
}

TEST_P(CameraConformance, StartsAgainAfterEachStop) {
  for (int round = 0; round < 3; ++round) {
    start();
    capture_in_order(4);
    camera_->stop();
    pause(std::chrono::milliseconds(130));
  }
}

TEST_P(CameraConformance, StopsWithUnfetchedFrames) {
  for (int round = 0; round < 3; ++round) {
    start();
    capture_in_order(1);
    pause(several_frames());
    camera_->stop();
  }
}

TEST_P(CameraConformance, FramesHeldAcrossAStopDoNotChange) {
  start();
  const Frame first = capture();
  const Frame second = capture();
  const auto first_bytes = copy_bytes(first);
  const auto second_bytes = copy_bytes(second);
  camera_->stop();
  EXPECT_EQ(copy_bytes(first), first_bytes);
  start();
  for (int i = 0; i < 5; ++i) capture();
  EXPECT_EQ(copy_bytes(first), first_bytes);
  EXPECT_EQ(copy_bytes(second), second_bytes);
  camera_.reset();
  EXPECT_EQ(copy_bytes(second), second_bytes);
}

TEST_P(CameraConformance, AFrameMayOutliveItsStartedCamera) {
  start();
  const Frame frame = capture();
  const auto bytes = copy_bytes(frame);
  make(kBuffers);
  start();
  capture_in_order(1);
  EXPECT_EQ(copy_bytes(frame), bytes);
}

TEST_P(CameraConformance, AllBuffersCanBeHeldAndReturned) {
  start();
  for (int round = 0; round < 3; ++round) {
    const uint64_t lost_before = camera_->counters().no_buffer;
    std::vector<Frame> held;
    for (int i = 0; i < camera_->description().buffers; ++i) held.push_back(capture());
    Frame frame;
    EXPECT_EQ(camera_->next_frame(several_frames(), frame), FrameEvent::kTimeout);
    const uint64_t newest = held.back().sequence;
    held.clear();
    EXPECT_GT(capture().sequence, newest + 1) << "the lost frames must show as a gap";
    EXPECT_GT(camera_->counters().no_buffer, lost_before);
  }
}

TEST_P(CameraConformance, AFrameCanBeDroppedByAnotherThread) {
  start();
  for (int i = 0; i < 3 * camera_->description().buffers; ++i) {
    std::thread([frame = capture()] { EXPECT_TRUE(frame.buffer); }).join();
  }
  EXPECT_EQ(camera_->counters().no_buffer, 0U);
}

TEST_P(CameraConformance, ATimeoutDoesNotChangeTheFrame) {
  start();
  Frame frame = capture();
  // On a slow machine, a few frames of a device may be waiting.
  auto event = camera_->next_frame(Duration::zero(), frame);
  for (int i = 0; i < kBuffers && event == FrameEvent::kFrame; ++i) {
    event = camera_->next_frame(Duration::zero(), frame);
  }
  EXPECT_EQ(event, FrameEvent::kTimeout);
  const Time time = frame.time;
  EXPECT_EQ(camera_->next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
  EXPECT_TRUE(frame.buffer);
  EXPECT_EQ(frame.time, time);
}

TEST_P(CameraConformance, LeaksNoDescriptor) {
  const auto use_once = [this] {
    start();
    capture_in_order(2);
    camera_->stop();
    pause(std::chrono::milliseconds(130));
  };
  use_once();
  const int before = open_descriptors();
  for (int i = 0; i < 10; ++i) use_once();
  EXPECT_EQ(open_descriptors(), before);
}

TEST_P(CameraConformance, ReconnectsAfterItWasUnplugged) {
  const CameraDevices& devices = camera_devices();
  if (!GetParam().is_device || devices.unplug_command.empty()) {
    GTEST_SKIP() << "there is no command that unplugs this camera";
  }
  start();
  const Frame held = capture();
  const auto held_bytes = copy_bytes(held);
  ASSERT_EQ(std::system(devices.unplug_command.c_str()), 0);
  const Time give_up = clock().now() + timeout();
  Frame frame;
  auto event = camera_->next_frame(several_frames(), frame);
  while (event && clock().now() < give_up) event = camera_->next_frame(several_frames(), frame);
  ASSERT_FALSE(event) << "next_frame() must fail for an unplugged camera";
  std::printf("unplugged: %s\n", event.error().message.c_str());
  EXPECT_EQ(copy_bytes(held), held_bytes);
  camera_->stop();
  const Status refused = camera_->start();
  ASSERT_FALSE(refused);
  std::printf("start: %s\n", refused.error().message.c_str());
  ASSERT_EQ(std::system(devices.replug_command.c_str()), 0);
  ASSERT_TRUE(starts_within(timeout()));
  latest_time_ = Time::min();
  capture_in_order(3);
  EXPECT_EQ(copy_bytes(held), held_bytes);
}

INSTANTIATE_TEST_SUITE_P(Cameras, CameraConformance, testing::ValuesIn(cameras_under_test()),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           for (char& letter : name) {
                             if (std::isalnum(static_cast<unsigned char>(letter)) == 0)
                               letter = '_';
                           }
                           return name;
                         });

}  // namespace
}  // namespace bevloc::drivers
