#include "firmware/runtime/watchdog.h"

#include <array>

#include <gtest/gtest.h>

#include "tests/firmware/runtime/fake_manager.h"
#include "tests/support/mock_gpio.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using test::MockGpio;

class WatchdogTest : public testing::Test {
 protected:
  WatchdogTest() {
    for (size_t i = 0; i < kThreads; ++i) {
      watchdog_.watch("thread " + std::to_string(i), beats_[i]);
    }
  }

  /// One period, in which all threads beat but `stopped`. Returns what systemd was sent.
  std::string step(std::optional<size_t> stopped = {}) {
    clock_.advance(Watchdog::kPeriod);
    for (size_t i = 0; i < kThreads; ++i) {
      if (i != stopped) beats_[i].beat();
    }
    watchdog_.step(clock_.now());
    return manager_.all();
  }

  bool fault() const { return gpio_.high("fault"); }

  static constexpr size_t kThreads = 12;
  FakeManager manager_;
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  MockGpio gpio_{{"fault"}, clock_};
  std::unique_ptr<FaultLine> line_ =
      FaultLine::open(drivers::LineAddress{MockGpio::kChip, "fault"}, gpio_).value();
  std::atomic<HealthState> state_{HealthState::kTracking};
  std::array<Heartbeat, kThreads> beats_;
  Watchdog watchdog_{state_, line_.get()};
};

TEST_F(WatchdogTest, IsReadyWhenEveryThreadHasMoved) {
  EXPECT_EQ(step(3), "");
  EXPECT_TRUE(fault());
  EXPECT_EQ(step(), "READY=1\nWATCHDOG=1\n");
  EXPECT_FALSE(fault());
  EXPECT_EQ(step(), "WATCHDOG=1\n");
}

TEST_F(WatchdogTest, IsNeverReadyWithoutOneThread) {
  for (int k = 0; k < 50; ++k) EXPECT_EQ(step(7), "");
  EXPECT_TRUE(fault());
  EXPECT_EQ(watchdog_.hung(), "thread 7");
}

TEST_F(WatchdogTest, DoesNotFeedLaterThanOneSecondAfterAnyThreadHasStopped) {
  for (size_t stopped = 0; stopped < kThreads; ++stopped) {
    step();
    for (int tenths = 1; tenths < 30; ++tenths) {
      const std::string sent = step(stopped);
      if (tenths < 10) continue;
      EXPECT_EQ(sent, "") << stopped << " after " << tenths << " tenths of a second";
      EXPECT_EQ(watchdog_.hung(), "thread " + std::to_string(stopped));
      EXPECT_TRUE(fault());
    }
    EXPECT_EQ(step(), "WATCHDOG=1\n") << "every thread moves again";
    EXPECT_EQ(watchdog_.hung(), "");
    EXPECT_FALSE(fault());
  }
}

TEST_F(WatchdogTest, AThreadMaySayThatItNeedsLonger) {
  step();
  beats_[2].beat(std::chrono::seconds(10));
  for (int tenths = 0; tenths < 100; ++tenths) EXPECT_EQ(step(2), "WATCHDOG=1\n") << tenths;
  step(2);
  EXPECT_EQ(step(2), "");
}

TEST_F(WatchdogTest, AThreadThatHasEndedDoesNotHang) {
  step();
  beats_[4].end();
  for (int tenths = 0; tenths < 30; ++tenths) EXPECT_EQ(step(4), "WATCHDOG=1\n");
}

TEST_F(WatchdogTest, NamesSeveralThreads) {
  step();
  for (int tenths = 0; tenths < 20; ++tenths) {
    clock_.advance(Watchdog::kPeriod);
    for (size_t i = 2; i < kThreads; ++i) beats_[i].beat();
    watchdog_.step(clock_.now());
  }
  EXPECT_EQ(watchdog_.hung(), "thread 0, thread 1");
}

TEST_F(WatchdogTest, TheFaultLineShowsTheStateFault) {
  step();
  state_ = HealthState::kFault;
  EXPECT_EQ(step(), "WATCHDOG=1\n");
  EXPECT_TRUE(fault());
  state_ = HealthState::kLost;
  step();
  EXPECT_FALSE(fault());
}

TEST_F(WatchdogTest, ItsThreadStepsAndSetsTheFaultLineAtItsEnd) {
  drivers::MonotonicClock machine;
  const uint64_t before = watchdog_.heartbeat().count();
  std::jthread thread = start_watchdog(watchdog_, *line_, machine);
  while (watchdog_.heartbeat().count() < before + 2) {
    for (Heartbeat& beat : beats_) beat.beat();
    std::this_thread::yield();
  }
  thread.request_stop();
  thread.join();
  EXPECT_NE(manager_.all().find("WATCHDOG=1"), std::string::npos);
  EXPECT_TRUE(fault());
}

}  // namespace
}  // namespace bevloc::firmware
