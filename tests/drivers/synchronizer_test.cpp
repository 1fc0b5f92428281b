#include "drivers/frameset/synchronizer.h"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

constexpr int kFront = 1;
constexpr int kBack = 4;

Time at_ms(int64_t ms) {
  return Time(milliseconds(ms));
}

Frame frame_of(int camera, Time time) {
  Frame frame;
  frame.camera = camera;
  frame.time = time;
  return frame;
}

class Synchronizer : public testing::Test {
 protected:
  static SynchronizerConfig config() {
    return {.tolerance = milliseconds(2), .wait = milliseconds(60), .min_cameras = 2};
  }

  FrameFate add(int camera, int64_t time_ms, int64_t now_ms) {
    return synchronizer_.add(frame_of(camera, at_ms(time_ms)), at_ms(now_ms));
  }

  /// All cameras except `absent` deliver a frame of the time `time_ms` 20 ms later.
  void add_all_but(CameraMask absent, int64_t time_ms) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      if (!absent[camera]) add(camera, time_ms, time_ms + 20);
    }
  }

  std::optional<Frameset> poll(int64_t now_ms) { return synchronizer_.poll(at_ms(now_ms)); }

  static CameraMask only(int camera) { return CameraMask(1U << camera); }

  FramesetSynchronizer synchronizer_{config()};
};

TEST_F(Synchronizer, ACompleteSetIsEmittedAtOnce) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    EXPECT_FALSE(poll(1020)) << "before camera " << camera;
    EXPECT_EQ(add(camera, 1000 + camera % 3, 1020), FrameFate::kAccepted);
  }
  const auto set = poll(1020);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->time, at_ms(1000));
  EXPECT_TRUE(set->present.all());
  EXPECT_EQ(set->spread, milliseconds(2));
  for (int camera = 0; camera < kCameraCount; ++camera) {
    EXPECT_EQ(set->frames[camera].camera, camera);
    EXPECT_EQ(set->frames[camera].time, at_ms(1000 + camera % 3));
  }
  EXPECT_FALSE(poll(2000));
}

TEST_F(Synchronizer, MissingCameraIsWaitedForAndNamed) {
  EXPECT_TRUE(synchronizer_.blockers().none());
  EXPECT_FALSE(synchronizer_.deadline());
  add_all_but(only(kBack), 1000);
  EXPECT_EQ(synchronizer_.blockers(), only(kBack));
  EXPECT_EQ(synchronizer_.deadline(), at_ms(1060));
  EXPECT_FALSE(poll(1059));
  const auto set = poll(1060);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->present, ~only(kBack));
  EXPECT_EQ(synchronizer_.counters(kBack).missing, 1U);
  EXPECT_EQ(synchronizer_.counters(kBack).waited_for, 1U);
  EXPECT_EQ(synchronizer_.counters(kFront).missing, 0U);
}

TEST_F(Synchronizer, CameraWithALaterFrameIsNotWaitedFor) {
  add(kBack, 1100, 1120);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (camera != kBack) add(camera, 1000, 1120);
  }
  const auto set = poll(1120);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->time, at_ms(1000));
  EXPECT_EQ(set->present, ~only(kBack));
  EXPECT_EQ(synchronizer_.counters(kBack).missing, 1U);
  EXPECT_EQ(synchronizer_.counters(kBack).waited_for, 0U);
}

TEST_F(Synchronizer, AFrameOfAnEmittedSetIsLate) {
  add_all_but(only(kBack), 1000);
  ASSERT_TRUE(poll(1060));
  EXPECT_EQ(add(kBack, 1002, 1070), FrameFate::kLate);
  EXPECT_EQ(synchronizer_.counters(kBack).late, 1U);
  EXPECT_FALSE(poll(2000));
}

TEST_F(Synchronizer, FrameBeyondToleranceOpensItsOwnSet) {
  add_all_but(only(kBack), 1000);
  add(kBack, 1003, 1023);
  const auto set = poll(1023);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->present, ~only(kBack));
  // One camera is too few for a frameset.
  EXPECT_FALSE(poll(1063));
  EXPECT_EQ(synchronizer_.counters(kBack).unmatched, 1U);
  EXPECT_EQ(synchronizer_.counters(kBack).late, 0U);
}

TEST_F(Synchronizer, RefusesDuplicatesOldFramesAndTheFuture) {
  EXPECT_EQ(add(kFront, 1000, 1020), FrameFate::kAccepted);
  EXPECT_EQ(add(kFront, 1000, 1021), FrameFate::kDuplicate);
  EXPECT_EQ(add(kFront, 900, 1022), FrameFate::kOutOfOrder);
  EXPECT_EQ(add(kFront, 5000, 1023), FrameFate::kFuture);
  // A wrong timestamp must not block the camera.
  EXPECT_EQ(add(kFront, 1100, 1120), FrameFate::kAccepted);
  const SynchronizerCounters& counters = synchronizer_.counters(kFront);
  EXPECT_EQ(counters.added, 5U);
  EXPECT_EQ(counters.duplicate, 1U);
  EXPECT_EQ(counters.out_of_order, 1U);
  EXPECT_EQ(counters.future, 1U);
}

TEST_F(Synchronizer, TooFewCamerasGiveNoSet) {
  add(kFront, 1000, 1020);
  EXPECT_FALSE(poll(1100));
  EXPECT_EQ(synchronizer_.counters(kFront).unmatched, 1U);
  EXPECT_EQ(synchronizer_.counters(kBack).missing, 0U);
  // Two cameras are enough.
  add(kFront, 1100, 1120);
  add(kBack, 1101, 1120);
  const auto set = poll(1160);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->present, only(kFront) | only(kBack));
}

TEST_F(Synchronizer, UnpolledQueueKeepsTheNewest) {
  constexpr int kFrames = FramesetSynchronizer::kQueueCapacity + 3;
  for (int k = 0; k < kFrames; ++k) add_all_but({}, 1000 + 100 * k);
  EXPECT_EQ(synchronizer_.counters(kFront).overflow, 3U);
  int sets = 0;
  while (const auto set = poll(1000 + 100 * kFrames)) {
    EXPECT_EQ(set->time, at_ms(1300 + 100 * sets));
    ++sets;
  }
  EXPECT_EQ(sets, FramesetSynchronizer::kQueueCapacity);
}

TEST_F(Synchronizer, ADeadCameraIsNotWaitedForUntilItRecovers) {
  int64_t time_ms = 1000;
  for (int k = 0; k < FramesetSynchronizer::kPatience; ++k, time_ms += 100) {
    add_all_but(only(kBack), time_ms);
    EXPECT_FALSE(poll(time_ms + 20)) << "set " << k;
    EXPECT_TRUE(poll(time_ms + 60)) << "set " << k;
  }
  add_all_but(only(kBack), time_ms);
  EXPECT_TRUE(synchronizer_.blockers().none());
  EXPECT_TRUE(poll(time_ms + 20));
  // The frameset of its first frame was emitted already. After this frame the synchronizer waits
  // for the camera again.
  EXPECT_EQ(add(kBack, time_ms, time_ms + 21), FrameFate::kLate);
  time_ms += 100;
  add_all_but(only(kBack), time_ms);
  EXPECT_FALSE(poll(time_ms + 20));
  add(kBack, time_ms, time_ms + 21);
  const auto set = poll(time_ms + 21);
  ASSERT_TRUE(set);
  EXPECT_TRUE(set->present.all());
  EXPECT_EQ(synchronizer_.counters(kBack).waited_for,
            static_cast<uint64_t>(FramesetSynchronizer::kPatience));
}

/// The wait is longer than the time in which the queues of the other cameras fill.
class PatientSynchronizer : public testing::TestWithParam<int> {};

TEST_P(PatientSynchronizer, OneDeadCameraDoesNotStopTheFramesets) {
  const Duration wait = milliseconds(GetParam());
  FramesetSynchronizer synchronizer({.tolerance = milliseconds(2), .wait = wait, .min_cameras = 3});
  constexpr Duration kPeriod = milliseconds(100);
  constexpr Duration kDelay = milliseconds(20);
  constexpr int kPeriods = 50;
  Time latest;
  int sets = 0;
  for (int k = 0; k < kPeriods; ++k) {
    const Time exposure = at_ms(1000) + k * kPeriod;
    const Time now = exposure + kDelay;
    for (int camera = 1; camera < kCameraCount; ++camera) {
      EXPECT_EQ(synchronizer.add(frame_of(camera, exposure), now), FrameFate::kAccepted);
    }
    while (const auto set = synchronizer.poll(now)) {
      EXPECT_EQ(set->present, CameraMask().set().reset(0));
      EXPECT_EQ(set->time, at_ms(1000) + sets * kPeriod) << "no frame may be dropped";
      latest = set->time;
      ++sets;
    }
    const bool patience_is_over =
        k >= FramesetSynchronizer::kPatience + FramesetSynchronizer::kQueueCapacity;
    if (patience_is_over) {
      EXPECT_EQ(latest, exposure) << "the dead camera adds no latency";
    }
  }
  EXPECT_EQ(sets, kPeriods);
  EXPECT_EQ(synchronizer.counters(1).overflow, 0U);
}

INSTANTIATE_TEST_SUITE_P(WaitMs, PatientSynchronizer, testing::Values(440, 500, 1000));

TEST_F(Synchronizer, ACameraWithAWrongClockIsNotWaitedFor) {
  for (int64_t time_ms = 1000; time_ms < 2000; time_ms += 100) {
    EXPECT_EQ(add(kBack, time_ms + 3'600'000, time_ms + 20), FrameFate::kFuture);
    add_all_but(only(kBack), time_ms);
    const bool is_patient = time_ms < 1000 + 100 * FramesetSynchronizer::kPatience;
    EXPECT_EQ(poll(time_ms + 20).has_value(), !is_patient) << time_ms;
    if (is_patient) {
      EXPECT_TRUE(poll(time_ms + 60));
    }
  }
}

TEST_F(Synchronizer, AllCamerasBackAfterLongSilence) {
  add_all_but({}, 1000);
  ASSERT_TRUE(poll(1020));
  EXPECT_FALSE(poll(11000));
  add_all_but({}, 11000);
  const auto set = poll(11020);
  ASSERT_TRUE(set);
  EXPECT_TRUE(set->present.all());
}

/// The cameras in `first` expose at t and the others 40 ms later, for `periods` periods.
class SplitCameras : public Synchronizer {
 protected:
  void run(CameraMask first, int periods) {
    for (int k = 0; k < periods; ++k, time_ms_ += 100) {
      add_all_but(~first, time_ms_);
      poll(time_ms_ + 20);
      add_all_but(first, time_ms_ + 40);
      while (poll(time_ms_ + 60)) {
      }
    }
  }
  bool split() const { return synchronizer_.splits().split(); }

  int64_t time_ms_ = 1000;
};

TEST_F(SplitCameras, SynchronizedCamerasAreNotSplit) {
  run(CameraMask().set(), 50);
  EXPECT_FALSE(split());
}

TEST_F(SplitCameras, UnsynchronizedCamerasAreSplitUntilTheySynchronizeAgain) {
  run(CameraMask(0b000111), 3);
  EXPECT_TRUE(split());
  run(CameraMask().set(), SplitMonitor::kMemory);
  EXPECT_FALSE(split());
}

TEST_F(SplitCameras, OneUnsynchronizedCameraIsDetectedAlthoughItsSetsAreDropped) {
  run(~only(kBack), 4);
  EXPECT_TRUE(split());
  EXPECT_GT(synchronizer_.counters(kBack).unmatched, 0U);
}

TEST_F(SplitCameras, LostFramesAreNotASplit) {
  for (int k = 0; k < 60; ++k, time_ms_ += 100) {
    add_all_but(CameraMask(k % 2 == 0 ? 0b000011 : 0b001100), time_ms_);
    while (poll(time_ms_ + 60)) {
    }
  }
  EXPECT_FALSE(split());
}

TEST_F(SplitCameras, NamesTheDriftingCamera) {
  for (int k = 0; k < 200; ++k) {
    const Duration drift = std::chrono::microseconds(20 * k);  // 200 ppm
    for (int camera = 0; camera < kCameraCount; ++camera) {
      const Time time = at_ms(1000 + 100 * k) + (camera == kBack ? drift : Duration::zero());
      synchronizer_.add(frame_of(camera, time), time + milliseconds(20));
    }
    while (poll(1000 + 100 * k + 90)) {
    }
  }
  ASSERT_TRUE(synchronizer_.rates().drift(kBack));
  EXPECT_TRUE(synchronizer_.rates().drift(kBack)->certain());
  EXPECT_NEAR(synchronizer_.rates().drift(kBack)->ppm, -200.0, 1.0);
  EXPECT_FALSE(synchronizer_.rates().drift(kFront)->certain());
}

}  // namespace
}  // namespace bevloc::drivers
