#include "drivers/gnss/fix_clock.h"

#include <gtest/gtest.h>
#include <sys/timex.h>

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr Duration kUtcAtStart = seconds(1'795'472'584);

/// A fix that held at `held` of the steady clock and arrives `delay` later.
FixTime judge(FixClock& clock, Time held, Duration delay, const ClockDiscipline& discipline = {}) {
  const Duration utc = kUtcAtStart + held.time_since_epoch();
  const Time arrival = held + delay;
  return clock.judge(utc, {arrival, arrival.time_since_epoch(), {utc + delay, discipline}});
}

/// A clock that has seen three reports with a delay of 80 ms.
class ArrivalTest : public testing::Test {
 protected:
  ArrivalTest() {
    EXPECT_EQ(judge(clock_, next(), milliseconds(80)).verdict, FixVerdict::kLearning);
    EXPECT_EQ(judge(clock_, next(), milliseconds(80)).verdict, FixVerdict::kLearning);
    EXPECT_EQ(judge(clock_, next(), milliseconds(80)).verdict, FixVerdict::kUsable);
  }
  Time next() { return held_ += milliseconds(200); }

  FixClock clock_{{.latency = milliseconds(100), .latency_sigma = milliseconds(30)}};
  Time held_{};
};

TEST_F(ArrivalTest, AReportIsAsOldAsTheLatency) {
  const Time held = next();
  const FixTime fix = judge(clock_, held, milliseconds(80));
  ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
  EXPECT_EQ(fix.time, held - milliseconds(20)) << "80 ms late, but 100 ms were configured";
  EXPECT_EQ(fix.sigma, milliseconds(30));
}

TEST_F(ArrivalTest, ADelayedReportHeldEarlier) {
  for (const int delay_ms : {80, 130, 400, 90}) {
    const Time held = next();
    const FixTime fix = judge(clock_, held, milliseconds(delay_ms));
    ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
    EXPECT_EQ(fix.time, held - milliseconds(20)) << delay_ms;
  }
  EXPECT_EQ(clock_.max_usable_age(), milliseconds(420));
}

/// The kernel slews a system clock that was wrong by 500 ppm, and the steady clock with it.
TEST_F(ArrivalTest, AReportIsNoOlderWhileATimeServiceSteersTheClock) {
  const auto steered = [](Time time) { return time + time.time_since_epoch() / 2000; };
  for (int i = 0; i < 1000; ++i) {
    const Time held = next();
    const Time arrival = held + milliseconds(80);
    const FixTime fix = clock_.judge(kUtcAtStart + held.time_since_epoch(),
                                     {steered(arrival), arrival.time_since_epoch(), {}});
    ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
    ASSERT_EQ(fix.time, steered(arrival) - milliseconds(100)) << i;
  }
}

TEST_F(ArrivalTest, RefusesAStaleReport) {
  EXPECT_EQ(judge(clock_, next(), milliseconds(980)).verdict, FixVerdict::kUsable);
  EXPECT_EQ(judge(clock_, next(), milliseconds(981)).verdict, FixVerdict::kStale);
}

TEST_F(ArrivalTest, RefusesTheSameFixTwice) {
  const Time held = next();
  EXPECT_EQ(judge(clock_, held, milliseconds(80)).verdict, FixVerdict::kUsable);
  EXPECT_EQ(judge(clock_, held, milliseconds(90)).verdict, FixVerdict::kRepeated);
  EXPECT_EQ(judge(clock_, held - milliseconds(100), milliseconds(200)).verdict,
            FixVerdict::kRepeated);
}

TEST_F(ArrivalTest, DoesNotTakeALastingDelayForTheUsualOne) {
  for (int i = 0; i < 4 * 60 * 5; ++i) {
    ASSERT_EQ(judge(clock_, next(), milliseconds(1500)).verdict, FixVerdict::kStale) << i;
  }
}

TEST_F(ArrivalTest, ASingleReportWithAWrongUtcDoesNotShiftTheOthers) {
  judge(clock_, next(), milliseconds(-70));
  for (int i = 0; i < 5 * 60; ++i) {
    const Time held = next();
    const FixTime fix = judge(clock_, held, milliseconds(80));
    ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
    ASSERT_EQ(fix.time, held - milliseconds(20)) << i;
  }
}

TEST_F(ArrivalTest, KnowsOneReportInTenSeconds) {
  for (int i = 0; i < 100; ++i) {
    const Time held = held_ += seconds(10);
    const FixTime fix = judge(clock_, held, milliseconds(80));
    ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
    ASSERT_EQ(fix.time, held - milliseconds(20)) << i;
  }
}

TEST_F(ArrivalTest, LearnsAnewOverMinutes) {
  // The clock of the machine is 50 ppm slow, which is 15 ms in five minutes.
  for (int i = 0; i < 20 * 60 * 5; ++i) {
    const Time held = next();
    const Duration drift = -(held.time_since_epoch() / 20'000);
    const FixTime fix = judge(clock_, held, milliseconds(80) + drift);
    ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
    ASSERT_LE(std::chrono::abs(fix.time - (held + drift - milliseconds(20))), milliseconds(1));
  }
  for (int i = 0; i < 20 * 60 * 5; ++i) {
    const Duration drift = milliseconds(-120) + held_.time_since_epoch() / 20'000;
    const FixTime fix = judge(clock_, next(), milliseconds(80) + drift);
    ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
    ASSERT_LE(fix.time, held_ + drift - milliseconds(19));
    ASSERT_GE(fix.time, held_ + drift - milliseconds(40)) << "at most 16 ms too early";
  }
}

TEST_F(ArrivalTest, LearnsAnewWhenUtcGoesBack) {
  held_ -= seconds(18);
  const auto late = [&] { return judge(clock_, next(), seconds(18) + milliseconds(80)); };
  EXPECT_EQ(late().verdict, FixVerdict::kLearning);
  EXPECT_EQ(late().verdict, FixVerdict::kLearning);
  const FixTime fix = late();
  ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
  EXPECT_EQ(fix.time, held_ + seconds(18) - milliseconds(20));
}

/// A receiver that starts with a wrong number of leap seconds corrects it later.
TEST_F(ArrivalTest, LearnsAnewWhenUtcIsSetBackByALeapSecond) {
  for (int i = 0; i < 100; ++i) judge(clock_, held_ += milliseconds(100), milliseconds(80));
  FixTime fix;
  int reports = 0;
  while (fix.verdict != FixVerdict::kUsable && reports < 100) {
    held_ += milliseconds(100);
    fix = judge(clock_, held_ - seconds(1), seconds(1) + milliseconds(80));
    ++reports;
  }
  EXPECT_EQ(reports, 13) << "1.3 s";
  ASSERT_EQ(fix.verdict, FixVerdict::kUsable);
  EXPECT_EQ(fix.time, held_ - milliseconds(20));
}

/// A fix that is not older than max_age would be used, although it seems to be a second too old.
TEST_F(ArrivalTest, UsesNoFixWhileUtcMayBeSetBack) {
  clock_ = FixClock({.latency = milliseconds(100), .max_age = milliseconds(1900)});
  for (int i = 0; i < 10; ++i) judge(clock_, next(), milliseconds(80));
  int usable = 0;
  for (int i = 0; i < 20; ++i) {
    const Duration delay = milliseconds(i == 0 ? 150 : 80);
    const FixTime fix = judge(clock_, next() - seconds(1), seconds(1) + delay);
    if (fix.verdict != FixVerdict::kUsable) continue;
    ++usable;
    EXPECT_EQ(fix.time, held_ - milliseconds(20)) << i;
  }
  EXPECT_EQ(usable, 12);
}

TEST_F(ArrivalTest, OldFixesAmongLateOnesDoNotExcuseTheDelay) {
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(judge(clock_, next(), milliseconds(1500)).verdict, FixVerdict::kStale) << i;
    ASSERT_EQ(judge(clock_, held_ - milliseconds(100), milliseconds(1600)).verdict,
              FixVerdict::kRepeated);
  }
}

TEST_F(ArrivalTest, AFewFixesOfASecondAgoDoNotSetUtcBack) {
  for (int i = 0; i < 10; ++i) {
    for (int k = 0; k < 5; ++k) {
      EXPECT_EQ(judge(clock_, next(), milliseconds(80)).verdict, FixVerdict::kUsable) << i;
    }
    EXPECT_EQ(judge(clock_, held_ - milliseconds(900), milliseconds(1000)).verdict,
              FixVerdict::kRepeated);
  }
}

class SystemClockTest : public testing::Test {
 protected:
  FixTime judged(Duration delay) { return judge(clock_, held_ += seconds(1), delay, discipline_); }

  FixClock clock_{{.timing = FixTiming::kSystemClock}};
  Time held_{};
  ClockDiscipline discipline_{.synchronized = true, .max_error = milliseconds(6)};
};

TEST_F(SystemClockTest, KnowsTheAge) {
  const FixTime fix = judged(milliseconds(130));
  ASSERT_EQ(fix.verdict, FixVerdict::kUsable) << "from the first fix on";
  EXPECT_EQ(fix.time, held_);
  EXPECT_EQ(fix.sigma, milliseconds(2));
  EXPECT_EQ(judged(milliseconds(1001)).verdict, FixVerdict::kStale);
}

TEST_F(SystemClockTest, ToleratesAsMuchFutureAsTheClockMayBeWrong) {
  EXPECT_EQ(judged(milliseconds(-6)).verdict, FixVerdict::kUsable);
  EXPECT_EQ(judged(milliseconds(-7)).verdict, FixVerdict::kFuture);
}

TEST_F(SystemClockTest, NeedsASynchronizedClock) {
  discipline_.max_error = milliseconds(101);
  EXPECT_EQ(judged(milliseconds(130)).verdict, FixVerdict::kUnsynchronized);
  discipline_ = {.synchronized = false, .max_error = milliseconds(6)};
  EXPECT_EQ(judged(milliseconds(130)).verdict, FixVerdict::kUnsynchronized);
}

TEST(ClockDisciplineTest, IsWhatTheKernelSays) {
  timex state{};
  state.maxerror = 1500;
  state.esterror = 200;
  const ClockDiscipline good = discipline_of(TIME_OK, state);
  EXPECT_TRUE(good.synchronized);
  EXPECT_EQ(good.max_error, std::chrono::microseconds(1500));
  EXPECT_EQ(good.estimated_error, std::chrono::microseconds(200));
  EXPECT_FALSE(discipline_of(TIME_ERROR, state).synchronized);
  EXPECT_FALSE(discipline_of(-1, state).synchronized) << "the kernel refused";
  state.status = STA_UNSYNC | STA_PLL;
  EXPECT_FALSE(discipline_of(TIME_OK, state).synchronized);
}

TEST(ClockDisciplineTest, IsReadWithTheTime) {
  const WallTime wall = read_wall_time();
  EXPECT_GT(wall.since_1970, seconds(1'700'000'000));
  EXPECT_GE(wall.discipline.max_error, Duration::zero());
}

}  // namespace
}  // namespace bevloc::drivers
