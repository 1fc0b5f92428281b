#include "firmware/stages/frameset_source.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

class FramesetSourceTest : public testing::Test {
 protected:
  FramesetSourceTest() { make({}, true); }

  void make(const drivers::SynchronizerConfig& config, bool compensates,
            const drivers::PulseLog* pulses = nullptr) {
    source_.emplace(config, compensates, pulses, frames_);
  }

  void push_all_but_one(Time time) {
    for (int camera = 0; camera < kCameraCount - 1; ++camera) push_frame(camera, time);
  }

  void push_frame(int camera, Time time) {
    drivers::Frame frame;
    frame.camera = camera;
    frame.time = time;
    frames_.push(std::move(frame));
  }

  /// One frame of each camera at equal intervals; `spread` is from the first to the last.
  void push_frameset(Time time, Duration spread = Duration::zero()) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      push_frame(camera, time + camera * spread / (kCameraCount - 1));
    }
  }

  std::optional<NewestFrameset> next() {
    source_->take_frames(clock_, Duration::zero());
    return source_->newest(clock_.now());
  }

  FrameQueue frames_{StageQueues::kFrames};
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  std::optional<FramesetSource> source_;
};

TEST_F(FramesetSourceTest, SkipsAndCountsOlderFramesets) {
  push_frameset(Time(milliseconds(800)));
  push_frameset(Time(milliseconds(900)));
  auto newest = next();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->frameset.time, Time(milliseconds(900)));
  EXPECT_TRUE(newest->skipped);
  EXPECT_EQ(source_->counters().skipped, 1U);
  EXPECT_EQ(source_->counters().frames_skipped, uint64_t{kCameraCount});

  push_frameset(Time(milliseconds(1000)));
  newest = next();
  ASSERT_TRUE(newest);
  EXPECT_FALSE(newest->skipped);
  EXPECT_FALSE(next());
}

TEST_F(FramesetSourceTest, ForgetsTheFramesFromBeforeASuspension) {
  for (const milliseconds suspension : {milliseconds(50), milliseconds(8 * 3'600'000)}) {
    make({}, true);
    push_all_but_one(clock_.now() - milliseconds(20));
    EXPECT_FALSE(next());
    clock_.suspend(suspension);
    clock_.advance(milliseconds(50));  // longer than the frameset waits
    EXPECT_FALSE(next());
    EXPECT_EQ(source_->counters().clock_gaps, 1U);
    push_frameset(clock_.now() + milliseconds(1));
    clock_.advance(milliseconds(1));
    EXPECT_TRUE(next());
    EXPECT_EQ(source_->counters().clock_gaps, 1U);
  }
}

TEST_F(FramesetSourceTest, AGapOfTheClockForgetsTheFramesFromBefore) {
  // Five cameras of a frameset wait for the sixth when the thread hangs.
  push_all_but_one(clock_.now() - milliseconds(20));
  EXPECT_FALSE(next());
  push_frame(0, clock_.now() - milliseconds(10));  // still in the queue
  clock_.advance(std::chrono::seconds(5));
  EXPECT_FALSE(next());
  EXPECT_EQ(source_->counters().clock_gaps, 1U);
  push_frameset(clock_.now());
  const auto newest = next();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->frameset.time, clock_.now());
  EXPECT_FALSE(newest->skipped);
  EXPECT_TRUE(newest->frameset.present.all());
  EXPECT_EQ(source_->counters().clock_gaps, 1U);
}

TEST_F(FramesetSourceTest, ALargeSpreadIsUnsynchronizedUnlessMotionIsCompensated) {
  for (const bool compensates : {false, true}) {
    make({.tolerance = milliseconds(50)}, compensates);
    push_frameset(Time(milliseconds(800)), milliseconds(4));
    auto newest = next();
    ASSERT_TRUE(newest);
    EXPECT_FALSE(newest->unsynchronized);
    push_frameset(Time(milliseconds(900)), milliseconds(40));
    newest = next();
    ASSERT_TRUE(newest);
    EXPECT_TRUE(newest->frameset.present.all());
    EXPECT_EQ(newest->frameset.time, Time(milliseconds(900)));
    EXPECT_EQ(newest->unsynchronized, !compensates);
  }
}

/// Half of the cameras expose 40 ms after the others.
TEST_F(FramesetSourceTest, CamerasOutOfStepAreUnsynchronized) {
  bool unsynchronized = false;
  for (int k = 0; k < 6; ++k) {
    const Time time = clock_.now();
    for (int camera = 0; camera < 3; ++camera) push_frame(camera, time);
    clock_.sleep_until(time + milliseconds(40));
    for (int camera = 3; camera < kCameraCount; ++camera) push_frame(camera, clock_.now());
    clock_.advance(milliseconds(60));
    while (const auto newest = next()) unsynchronized = newest->unsynchronized;
  }
  EXPECT_TRUE(unsynchronized);
}

TEST_F(FramesetSourceTest, ReportsUnsynchronizedCamerasWhenNoFramesetHasEnoughCameras) {
  make({.min_cameras = 4}, true);
  int reports = 0;
  for (int k = 0; k < 20; ++k) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      push_frame(camera, clock_.now() + milliseconds(camera < 3 ? 0 : 40));
    }
    clock_.advance(milliseconds(100));
    EXPECT_FALSE(next());
    if (source_->unsynchronized_without_framesets(clock_.now())) ++reports;
    EXPECT_FALSE(source_->unsynchronized_without_framesets(clock_.now()));
  }
  EXPECT_GE(reports, 5);
  EXPECT_LE(reports, 10);
  // Cameras that send nothing are not out of step.
  clock_.advance(milliseconds(1000));
  EXPECT_FALSE(next());
  EXPECT_FALSE(source_->unsynchronized_without_framesets(clock_.now()));
}

TEST_F(FramesetSourceTest, MeasuresTheSpreadAndCountsFramesetsWithoutAPulse) {
  drivers::PulseLog pulses;
  make({}, true, &pulses);
  pulses.add(Time(milliseconds(699)));
  push_frameset(Time(milliseconds(700)), milliseconds(2));
  ASSERT_TRUE(next());
  EXPECT_EQ(source_->synchrony().off_pulse, 0U);
  push_frameset(Time(milliseconds(800)), milliseconds(1));
  ASSERT_TRUE(next());
  EXPECT_EQ(source_->synchrony().off_pulse, 1U);
  EXPECT_EQ(source_->synchrony().spread.load(), milliseconds(1));
  EXPECT_EQ(source_->synchrony().spread_max.load(), milliseconds(2));
}

}  // namespace
}  // namespace bevloc::firmware
