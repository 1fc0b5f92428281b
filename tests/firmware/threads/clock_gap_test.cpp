#include "firmware/threads/clock_gap.h"

#include <gtest/gtest.h>

#include "drivers/clock/clock.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

class ClockGapTest : public testing::Test {
 protected:
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  ClockGapDetector gaps_;

  bool look() { return gaps_.look(clock_.now(), clock_.suspended()); }
};

TEST_F(ClockGapTest, BusCyclesAndALateOneAreNoGap) {
  for (int k = 0; k < 100; ++k) {
    EXPECT_FALSE(look());
    clock_.advance(milliseconds(10));
  }
  clock_.advance(milliseconds(290));
  EXPECT_FALSE(look());
}

TEST_F(ClockGapTest, AProcessThatDidNotRunHasAGap) {
  look();
  clock_.advance(milliseconds(301));
  EXPECT_TRUE(look());
  clock_.advance(milliseconds(10));
  EXPECT_FALSE(look());
}

TEST_F(ClockGapTest, TheSteadyClockDoesNotShowASuspension) {
  look();
  clock_.suspend(std::chrono::hours(8));
  clock_.advance(milliseconds(10));
  EXPECT_TRUE(look());
  clock_.advance(milliseconds(10));
  EXPECT_FALSE(look());
}

/// At 30 m/s the vehicle drives 1.5 m in the shortest of these suspensions.
TEST_F(ClockGapTest, AShortSuspensionIsAGapToo) {
  look();
  for (const milliseconds suspension : {milliseconds(50), milliseconds(250)}) {
    clock_.suspend(suspension);
    clock_.advance(milliseconds(10));
    EXPECT_TRUE(look());
    clock_.advance(milliseconds(10));
    EXPECT_FALSE(look());
  }
}

TEST_F(ClockGapTest, AnErrorOfReadingTheClocksIsNoGap) {
  look();
  for (const milliseconds error : {milliseconds(2), milliseconds(-2)}) {
    clock_.suspend(error);
    clock_.advance(milliseconds(10));
    EXPECT_FALSE(look());
  }
}

TEST_F(ClockGapTest, AMachineThatWasSuspendedBeforeHasNoGap) {
  clock_.suspend(std::chrono::hours(8));
  EXPECT_FALSE(look());
  const drivers::MonotonicClock machine;
  EXPECT_GE(machine.suspended(), -milliseconds(1));
}

}  // namespace
}  // namespace bevloc::firmware
