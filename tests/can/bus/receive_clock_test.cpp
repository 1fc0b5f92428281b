#include "can/bus/receive_clock.h"

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr Time kSteady(seconds(100));
constexpr nanoseconds kRealtime = seconds(1'700'000'000);

/// Returns both clocks at the time `passed` after the start of the test.
ReceiveClock::Now now_after(Duration passed) {
  return {kSteady + passed, kRealtime + passed};
}

TEST(ReceiveClock, WithoutAStampAFrameArrivesNow) {
  ReceiveClock clock;
  const auto stamped = clock.to_steady({}, now_after(milliseconds(5)));
  EXPECT_EQ(stamped.time, kSteady + milliseconds(5));
  EXPECT_EQ(stamped.source, StampSource::kArrival);
}

TEST(ReceiveClock, ConvertsTheKernelsStamp) {
  ReceiveClock clock;
  const auto stamped =
      clock.to_steady({.software = kRealtime + milliseconds(2)}, now_after(milliseconds(5)));
  EXPECT_EQ(stamped.time, kSteady + milliseconds(2));
  EXPECT_EQ(stamped.source, StampSource::kSoftware);
}

TEST(ReceiveClock, SettingTheRealtimeClockGivesNoImpossibleTime) {
  ReceiveClock clock;
  EXPECT_EQ(clock.to_steady({.software = kRealtime}, now_after(milliseconds(1))).time, kSteady);
  // Set back by an hour, forward by an hour, and forward by little: the result always lies between
  // the previous frame and now.
  for (const Duration step :
       {-Duration(seconds(3600)), Duration(seconds(3600)), Duration(seconds(3))}) {
    auto now = now_after(milliseconds(10));
    now.realtime += step;
    const auto stamped = clock.to_steady({.software = kRealtime + milliseconds(9)}, now);
    EXPECT_GE(stamped.time, kSteady);
    EXPECT_LE(stamped.time, now.steady);
  }
}

TEST(ReceiveClock, HardwareStampsRemoveTheJitterOfTheInterrupt) {
  ReceiveClock clock;
  const nanoseconds controller = seconds(7);
  const int latency_us[] = {30, 900, 10, 500, 20, 700, 15};
  for (int i = 0; i < 7; ++i) {
    const Duration sent = milliseconds(10 * i);
    const Duration noticed = sent + microseconds(latency_us[i]);
    const auto stamped =
        clock.to_steady({.software = kRealtime + noticed, .hardware = controller + sent},
                        now_after(noticed + milliseconds(1)));
    EXPECT_EQ(stamped.source, StampSource::kHardware);
    // At most the smallest latency so far plus the largest drift since then.
    EXPECT_GE(stamped.time, kSteady + sent);
    EXPECT_LE(stamped.time, kSteady + sent + microseconds(35));
  }
}

TEST(ReceiveClock, FollowsADriftingController) {
  ReceiveClock clock;
  Time last{};
  for (int i = 0; i < 1000; ++i) {
    const Duration passed = milliseconds(100 * i);
    // 50 ppm slow: 5 ms behind after 100 s.
    const nanoseconds hardware = seconds(7) + passed - passed / 20'000;
    last =
        clock.to_steady({.software = kRealtime + passed, .hardware = hardware}, now_after(passed))
            .time;
    EXPECT_LE(kSteady + passed - last, Duration(microseconds(20)));
  }
}

TEST(ReceiveClock, FollowsAControllerThatRestarted) {
  ReceiveClock clock;
  clock.to_steady({.software = kRealtime, .hardware = seconds(500)}, now_after(Duration::zero()));
  const auto stamped = clock.to_steady(
      {.software = kRealtime + seconds(1), .hardware = milliseconds(3)}, now_after(seconds(1)));
  EXPECT_EQ(stamped.time, kSteady + seconds(1));
}

}  // namespace
}  // namespace bevloc::can
