#include "drivers/camera/paced_camera.h"

#include <algorithm>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

constexpr Duration kFramePeriod = milliseconds(100);
constexpr Duration kReadout = milliseconds(20);

/// Delivers `last` frames at 10 Hz from time 0 on. The first byte of each image is its number.
class CountingCamera final : public PacedCamera {
 public:
  CountingCamera(int buffers, uint64_t last, VirtualClock& clock)
      : PacedCamera({2, 4, 3, buffers}, milliseconds(8), clock), clock_(clock), last_(last) {
    set_max_lateness(kFramePeriod);
  }

  void break_frame(uint64_t number) { broken_ = number; }
  /// From now on, drawing an image takes this long.
  void set_drawing_time(Duration drawing_time) { drawing_time_ = drawing_time; }
  int drawn() const { return drawn_; }

 private:
  Status open(Time now) override {
    next_ = first_ =
        static_cast<uint64_t>((now.time_since_epoch() + kFramePeriod - Duration(1)) / kFramePeriod);
    return {};
  }
  std::optional<Delivery> next_delivery() override {
    if (next_ == last_) return std::nullopt;
    const Time start(static_cast<int64_t>(next_) * kFramePeriod);
    return Delivery{next_++ - first_, start, start, start + kReadout};
  }
  Status draw(const Delivery& delivery, RgbImage& image) override {
    ++drawn_;
    clock_.advance(drawing_time_);
    const uint64_t number = delivery.sequence + first_;
    if (number == broken_) return fail("frame {} is broken", number);
    image.pixels[0] = static_cast<uint8_t>(number);
    return {};
  }

  VirtualClock& clock_;
  Duration drawing_time_{0};
  uint64_t last_;
  uint64_t broken_ = ~uint64_t{0};
  uint64_t first_ = 0;
  uint64_t next_ = 0;
  int drawn_ = 0;
};

TEST(PacedCamera, DeliversWhenTheFrameIsReadOut) {
  VirtualClock clock;
  CountingCamera camera(2, 100, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  for (int k = 0; k < 5; ++k) {
    ASSERT_EQ(camera.next_frame(milliseconds(500), frame), FrameEvent::kFrame);
    EXPECT_EQ(clock.now(), Time(k * kFramePeriod + kReadout));
    EXPECT_EQ(frame.time, Time(k * kFramePeriod));
    EXPECT_EQ(frame.sequence, static_cast<uint64_t>(k));
    EXPECT_EQ(frame.camera, 2);
    EXPECT_EQ(frame.exposure, milliseconds(8));
    EXPECT_EQ(frame.pixels().data[0], k);
  }
}

TEST(PacedCamera, AZeroTimeoutDoesNotWait) {
  VirtualClock clock;
  CountingCamera camera(2, 100, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  EXPECT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
  clock.advance(kReadout - Duration(1));
  EXPECT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
  clock.advance(Duration(1));
  EXPECT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kFrame);
  EXPECT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kTimeout);
  EXPECT_EQ(clock.now(), Time(kReadout));
}

TEST(PacedCamera, TimeoutEndsTheWait) {
  VirtualClock clock(Time(milliseconds(21)));
  CountingCamera camera(2, 100, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  EXPECT_EQ(camera.next_frame(milliseconds(30), frame), FrameEvent::kTimeout);
  EXPECT_EQ(clock.now(), Time(milliseconds(51)));
}

TEST(PacedCamera, DrawsEachImageOnceAndAhead) {
  VirtualClock clock(Time(milliseconds(1)));
  CountingCamera camera(2, 100, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(camera.next_frame(milliseconds(1), frame), FrameEvent::kTimeout);
    EXPECT_EQ(camera.drawn(), 1);
  }
}

TEST(PacedCamera, UnfetchedFramesAreLostAndCounted) {
  VirtualClock clock;
  CountingCamera camera(2, 100, clock);
  ASSERT_TRUE(camera.start());
  clock.advance(kReadout + 10 * kFramePeriod);
  Frame frame;
  ASSERT_EQ(camera.next_frame(Duration::zero(), frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.sequence, 10U);
  EXPECT_EQ(camera.counters().overrun, 10U);
  EXPECT_EQ(camera.counters().delivered, 1U);
}

TEST(PacedCamera, DrawingAheadAddsNoLatency) {
  VirtualClock clock;
  CountingCamera camera(2, 100, clock);
  camera.set_drawing_time(milliseconds(90));
  ASSERT_TRUE(camera.start());
  Frame frame;
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(camera.next_frame(2 * kFramePeriod, frame), FrameEvent::kFrame);
    // The first image could not be drawn ahead. Each following frame recovers 10 ms of its delay.
    const Duration delay = milliseconds(std::max(0, 70 - 10 * k));
    EXPECT_EQ(clock.now() - frame.time, kReadout + delay) << k;
  }
  EXPECT_EQ(camera.counters().overrun, 0U);
}

TEST(PacedCamera, AFrameThatTookTooLongToDrawIsLost) {
  VirtualClock clock;
  CountingCamera camera(2, 100, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  ASSERT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kFrame);
  camera.set_drawing_time(milliseconds(500));
  EXPECT_EQ(camera.next_frame(3 * kFramePeriod, frame), FrameEvent::kTimeout);
  camera.set_drawing_time(Duration::zero());
  ASSERT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kFrame);
  EXPECT_LE(clock.now() - frame.time, kFramePeriod + kReadout);
  EXPECT_GT(camera.counters().overrun, 0U);
  EXPECT_EQ(frame.sequence, camera.counters().overrun + 1);
}

TEST(PacedCamera, FrameWithoutBufferIsLostAndCounted) {
  VirtualClock clock;
  CountingCamera camera(3, 100, clock);
  ASSERT_TRUE(camera.start());
  std::vector<Frame> held(3);
  for (Frame& frame : held) {
    ASSERT_EQ(camera.next_frame(kFramePeriod + kReadout, frame), FrameEvent::kFrame);
  }
  Frame frame;
  EXPECT_EQ(camera.next_frame(4 * kFramePeriod, frame), FrameEvent::kTimeout);
  EXPECT_EQ(camera.counters().no_buffer, 4U);
  held.clear();
  EXPECT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.sequence, 7U);
}

TEST(PacedCamera, ReportsItsEnd) {
  VirtualClock clock;
  CountingCamera camera(2, 2, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  EXPECT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kFrame);
  EXPECT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kFrame);
  EXPECT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kEnded);
}

TEST(PacedCamera, ABrokenFrameIsAnErrorAndTheNextOneIsDelivered) {
  VirtualClock clock;
  CountingCamera camera(2, 10, clock);
  camera.break_frame(1);
  ASSERT_TRUE(camera.start());
  Frame frame;
  ASSERT_EQ(camera.next_frame(kFramePeriod, frame), FrameEvent::kFrame);
  const auto broken = camera.next_frame(kFramePeriod, frame);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().message, "frame 1 is broken");
  ASSERT_EQ(camera.next_frame(3 * kFramePeriod, frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.sequence, 2U);
}

TEST(PacedCamera, FramesMayBeDroppedByAnotherThread) {
  VirtualClock clock;
  CountingCamera camera(4, 1000, clock);
  ASSERT_TRUE(camera.start());
  for (int i = 0; i < 50; ++i) {
    Frame frame;
    ASSERT_EQ(camera.next_frame(2 * kFramePeriod, frame), FrameEvent::kFrame);
    std::thread([i, held = std::move(frame)] { EXPECT_EQ(held.pixels().data[0], i); }).join();
  }
  EXPECT_EQ(camera.counters().no_buffer, 0U);
}

}  // namespace
}  // namespace bevloc::drivers
