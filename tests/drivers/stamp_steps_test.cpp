#include "drivers/camera/stamp_steps.h"

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

/// A camera of 10 Hz whose frames arrive 20 ms after their exposure.
class StampStepsTest : public testing::Test {
 protected:
  StampStepsTest() {
    for (int i = 0; i < 10; ++i) frame();
  }

  bool frame(Duration stamp_error = Duration::zero(), Duration late = Duration::zero()) {
    exposed_ += milliseconds(100);
    ++sequence_;
    return steps_.add(exposed_ + stamp_error, exposed_ + milliseconds(20) + late, sequence_);
  }
  void lose_frames(int count) {
    exposed_ += count * milliseconds(100);
    sequence_ += static_cast<uint64_t>(count);
  }
  /// Without a pulse no frame is exposed, so none is counted.
  void omit_pulse() { exposed_ += milliseconds(100); }

  StampSteps steps_;
  Time exposed_{milliseconds(1000)};
  uint64_t sequence_ = 0;
};

TEST_F(StampStepsTest, StampsThatJumpAreWrongUntilTheyJumpBack) {
  for (const Duration error : {milliseconds(-100), milliseconds(100), milliseconds(-50)}) {
    EXPECT_TRUE(frame(error));
    EXPECT_TRUE(frame(error)) << "the offset stays";
    EXPECT_EQ(steps_.offset(), error);
    EXPECT_FALSE(frame());
    EXPECT_EQ(steps_.offset(), Duration::zero());
  }
}

TEST_F(StampStepsTest, FramesThatArriveLateHaveRightStamps) {
  EXPECT_FALSE(frame({}, milliseconds(500)));
  EXPECT_FALSE(frame({}, milliseconds(400)));
  EXPECT_FALSE(frame({}, milliseconds(400)));
  EXPECT_FALSE(frame());
}

TEST_F(StampStepsTest, AJumpOfAFrameThatArrivesLateIsFound) {
  EXPECT_TRUE(frame(milliseconds(-100), milliseconds(30)));
  EXPECT_TRUE(frame(milliseconds(-100)));
  EXPECT_EQ(steps_.offset(), milliseconds(-100));
}

TEST_F(StampStepsTest, LostFramesAreNoJump) {
  lose_frames(1);
  EXPECT_FALSE(frame());
  lose_frames(3);
  EXPECT_FALSE(frame({}, milliseconds(60)));
  lose_frames(40);
  EXPECT_FALSE(frame());
}

TEST_F(StampStepsTest, AJumpBehindALostFrameIsFound) {
  lose_frames(1);
  EXPECT_TRUE(frame(milliseconds(-100)));
}

TEST_F(StampStepsTest, AnotherRateIsNoJump) {
  for (int i = 0; i < 10; ++i) {
    exposed_ -= milliseconds(50);  // 20 Hz
    EXPECT_FALSE(frame());
  }
}

TEST_F(StampStepsTest, SmallErrorsOfSingleStampsDoNotAddUp) {
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(frame(milliseconds(25)));
    EXPECT_FALSE(frame({}, milliseconds(60))) << "the jump back hides behind a late frame";
    for (int k = 0; k < 50; ++k) EXPECT_FALSE(frame());
  }
}

TEST_F(StampStepsTest, APulseThatIsOmittedBehindALateFrameIsNoJump) {
  EXPECT_FALSE(frame({}, milliseconds(31)));
  omit_pulse();
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(frame()) << i;
}

TEST_F(StampStepsTest, APulseThatIsOmittedBeforeALateFrameIsNoJump) {
  omit_pulse();
  EXPECT_FALSE(frame());
  EXPECT_FALSE(frame({}, milliseconds(31)));
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(frame()) << i;
}

TEST_F(StampStepsTest, ATimelyFrameDisprovesAJump) {
  omit_pulse();
  EXPECT_TRUE(frame({}, milliseconds(31))) << "as if its stamp were 100 ms late";
  EXPECT_FALSE(frame());
  omit_pulse();
  EXPECT_FALSE(frame());
  EXPECT_TRUE(frame({}, milliseconds(100))) << "as if its stamp were 100 ms early";
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(frame()) << i;
}

TEST_F(StampStepsTest, AJumpStaysAlthoughFramesAreLate) {
  for (const Duration error : {milliseconds(100), milliseconds(-100)}) {
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(frame(error, milliseconds(45 * (i % 3)))) << i;
      EXPECT_EQ(steps_.offset(), error);
    }
    EXPECT_FALSE(frame());
  }
}

TEST_F(StampStepsTest, AnOmittedPulseDoesNotExcuseEarlyStamps) {
  constexpr Duration kEarly = milliseconds(-100);
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(frame(kEarly));
  EXPECT_TRUE(frame(kEarly, milliseconds(31)));
  omit_pulse();
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(frame(kEarly)) << i;
}

TEST_F(StampStepsTest, AnOmittedPulseIsNoJumpOfACameraThatHasBecomeSlower) {
  const Duration slower = milliseconds(60);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(frame({}, slower));
  EXPECT_FALSE(frame({}, slower + milliseconds(31)));
  omit_pulse();
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(frame({}, slower)) << i;
}

TEST_F(StampStepsTest, CountsEachJumpThereAndBack) {
  EXPECT_EQ(steps_.jumps(), 0U);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(frame(milliseconds(-100)));
  EXPECT_EQ(steps_.jumps(), 1U);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(frame(milliseconds(-200)));
  EXPECT_EQ(steps_.jumps(), 2U);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(frame());
  EXPECT_EQ(steps_.jumps(), 3U);
  steps_.reset();
  EXPECT_EQ(steps_.jumps(), 3U);
}

TEST_F(StampStepsTest, FramesThatArriveLateAreNoJumps) {
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(frame({}, milliseconds(100 * i)));
  EXPECT_EQ(steps_.jumps(), 0U);
}

TEST_F(StampStepsTest, ANewStartForgetsTheOffset) {
  EXPECT_TRUE(frame(milliseconds(-100)));
  steps_.reset();
  EXPECT_FALSE(frame(milliseconds(-100)));
  EXPECT_FALSE(frame(milliseconds(-100)));
}

}  // namespace
}  // namespace bevloc::drivers
