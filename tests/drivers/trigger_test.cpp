#include "drivers/trigger/trigger.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/mock_gpio.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;
using test::MockGpio;

constexpr Duration kPulsePeriod = milliseconds(100);
constexpr Duration kWidth = milliseconds(2);
constexpr Duration kTimeout = milliseconds(50);

class TriggerTest : public testing::Test {
 protected:
  void run_until(Time end) {
    while (clock_.now() < end) trigger_.step(kTimeout);
  }

  std::vector<Time> rises() const {
    std::vector<Time> rises;
    for (const MockGpio::Change& change : gpio_.changes("trigger")) {
      if (change.high) rises.push_back(change.time);
    }
    return rises;
  }

  std::unique_ptr<OutputLine> open() {
    auto line = gpio_.open_output({MockGpio::kChip, "trigger"}, false);
    EXPECT_TRUE(line) << line.error().message;
    return std::move(*line);
  }

  VirtualClock clock_{Time(milliseconds(1000))};
  MockGpio gpio_{{"trigger"}, clock_};
  Trigger trigger_{open(), clock_, {kPulsePeriod, kWidth}};
};

TEST_F(TriggerTest, GivesAPulsePerPeriod) {
  run_until(Time(milliseconds(1450)));
  const auto changes = gpio_.changes("trigger");
  ASSERT_EQ(changes.size(), 8U);
  for (size_t i = 0; i < changes.size(); ++i) {
    const Time due = Time(milliseconds(1100)) + static_cast<int>(i / 2) * kPulsePeriod;
    EXPECT_EQ(changes[i].high, i % 2 == 0);
    EXPECT_EQ(changes[i].time, i % 2 == 0 ? due : due + kWidth);
  }
  EXPECT_EQ(trigger_.counters().skipped, 0U);
}

TEST_F(TriggerTest, WaitsNoLongerThanItsTimeout) {
  trigger_.step(milliseconds(30));
  EXPECT_EQ(clock_.now(), Time(milliseconds(1030)));
  EXPECT_TRUE(rises().empty());
}

TEST_F(TriggerTest, ALatePulseDoesNotDelayTheNext) {
  clock_.advance(milliseconds(108));
  run_until(Time(milliseconds(1250)));
  EXPECT_EQ(rises(), (std::vector{Time(milliseconds(1108)), Time(milliseconds(1200))}));
  EXPECT_EQ(trigger_.counters().max_lateness.load(), milliseconds(8));
  EXPECT_EQ(trigger_.counters().skipped, 0U);
}

TEST_F(TriggerTest, SkipsMissedPulses) {
  run_until(Time(milliseconds(1110)));
  // The process does not run for almost four periods.
  clock_.sleep_until(Time(milliseconds(1495)));
  run_until(Time(milliseconds(1650)));
  EXPECT_EQ(rises(), (std::vector{Time(milliseconds(1100)), Time(milliseconds(1500)),
                                  Time(milliseconds(1600))}));
  EXPECT_EQ(trigger_.counters().skipped, 3U);
}

TEST_F(TriggerTest, DoesNotDriftOverAnHour) {
  constexpr int kPulses = 36'000;
  run_until(Time(milliseconds(1000)) + kPulses * kPulsePeriod + kWidth);
  EXPECT_EQ(trigger_.pulses().count(), static_cast<uint64_t>(kPulses));
  EXPECT_EQ(rises().back(), Time(milliseconds(1000)) + kPulses * kPulsePeriod);
}

TEST_F(TriggerTest, CountsRefusedPulsesAndDoesNotLogThem) {
  gpio_.unplug();
  run_until(Time(milliseconds(1350)));
  EXPECT_EQ(trigger_.counters().failed, 3U);
  EXPECT_EQ(trigger_.pulses().count(), 0U);
}

TEST_F(TriggerTest, TheLogFindsThePulseOfAFrame) {
  run_until(Time(milliseconds(1350)));
  const PulseLog& pulses = trigger_.pulses();
  EXPECT_EQ(pulses.count(), 3U);
  EXPECT_EQ(pulses.newest_until(Time(milliseconds(1201))), Time(milliseconds(1200)));
  EXPECT_EQ(pulses.newest_until(Time(milliseconds(1200))), Time(milliseconds(1200)));
  EXPECT_EQ(pulses.newest_until(Time(milliseconds(1199))), Time(milliseconds(1100)));
  EXPECT_FALSE(pulses.newest_until(Time(milliseconds(1099))));
}

TEST(PulseLog, KeepsTheNewest) {
  PulseLog pulses;
  for (int k = 0; k < 3 * PulseLog::kCapacity; ++k) pulses.add(Time(milliseconds(k)));
  const int newest = 3 * PulseLog::kCapacity - 1;
  EXPECT_EQ(pulses.newest_until(Time(milliseconds(newest))), Time(milliseconds(newest)));
  const int oldest = newest - (PulseLog::kCapacity - 2);
  EXPECT_EQ(pulses.newest_until(Time(milliseconds(oldest))), Time(milliseconds(oldest)));
  EXPECT_FALSE(pulses.newest_until(Time(milliseconds(oldest - 1))));
}

}  // namespace
}  // namespace bevloc::drivers
