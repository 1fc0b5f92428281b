#include "firmware/threads/clock_gap.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

class ClockGapTest : public testing::Test {
 protected:
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  ClockGapDetector gaps_;
};

TEST_F(ClockGapTest, BusCyclesAndALateOneAreNoGap) {
  for (int k = 0; k < 100; ++k) {
    EXPECT_FALSE(gaps_.look(clock_));
    clock_.advance(milliseconds(10));
  }
  clock_.advance(milliseconds(290));
  EXPECT_FALSE(gaps_.look(clock_));
}

TEST_F(ClockGapTest, AProcessThatDidNotRunHasAGap) {
  gaps_.look(clock_);
  clock_.advance(milliseconds(301));
  EXPECT_TRUE(gaps_.look(clock_));
  clock_.advance(milliseconds(10));
  EXPECT_FALSE(gaps_.look(clock_));
}

TEST_F(ClockGapTest, TheSteadyClockDoesNotShowASuspension) {
  gaps_.look(clock_);
  clock_.suspend(std::chrono::hours(8));
  clock_.advance(milliseconds(10));
  EXPECT_TRUE(gaps_.look(clock_));
  clock_.advance(milliseconds(10));
  EXPECT_FALSE(gaps_.look(clock_));
}

TEST_F(ClockGapTest, AMachineThatWasSuspendedBeforeHasNoGap) {
  clock_.suspend(std::chrono::hours(8));
  EXPECT_FALSE(gaps_.look(clock_));
  const drivers::MonotonicClock machine;
  EXPECT_GE(machine.suspended(), -milliseconds(1));
}

}  // namespace
}  // namespace bevloc::firmware
