#include "drivers/clock/clock.h"

#include <gtest/gtest.h>

#include "common/kernel_time.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

TEST(VirtualClock, ChangesOnlyWhenItIsAdvanced) {
  VirtualClock clock(Time(milliseconds(100)));
  EXPECT_EQ(clock.now(), Time(milliseconds(100)));
  EXPECT_EQ(clock.now(), Time(milliseconds(100)));
  clock.advance(milliseconds(5));
  EXPECT_EQ(clock.now(), Time(milliseconds(105)));
}

TEST(VirtualClock, SleepingAdvancesItAndNeverSetsItBack) {
  VirtualClock clock;
  clock.sleep_until(Time(milliseconds(20)));
  EXPECT_EQ(clock.now(), Time(milliseconds(20)));
  clock.sleep_until(Time(milliseconds(10)));
  EXPECT_EQ(clock.now(), Time(milliseconds(20)));
}

TEST(KernelTime, ReadsTwoClocksAtOneMoment) {
  for (int i = 0; i < 1000; ++i) {
    const ClockPair clocks = read_with_steady(CLOCK_MONOTONIC);
    const Duration apart = clocks.clock - clocks.steady.time_since_epoch();
    ASSERT_LE(std::chrono::abs(apart), clocks.error);
  }
}

TEST(MonotonicClock, NeverGoesBack) {
  MonotonicClock clock;
  Time before = clock.now();
  for (int i = 0; i < 1000; ++i) {
    const Time now = clock.now();
    EXPECT_GE(now, before);
    before = now;
  }
}

TEST(MonotonicClock, DoesNotWakeBeforeTheTime) {
  MonotonicClock clock;
  const Time target = clock.now() + milliseconds(2);
  clock.sleep_until(target);
  EXPECT_GE(clock.now(), target);
}

TEST(MonotonicClock, DoesNotSleepUntilThePast) {
  MonotonicClock clock;
  const Time before = clock.now();
  clock.sleep_until(Time{});
  clock.sleep_until(Time::min());
  EXPECT_LT(clock.now() - before, std::chrono::minutes(1));
}

}  // namespace
}  // namespace bevloc::drivers
