#include "can/bus/receive_clock.h"

#include <algorithm>

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
  // The clock is set back by an hour, forward by an hour, and forward by little. The result always
  // lies between the previous frame and now.
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
    // The error is at most the smallest latency so far plus the largest drift since then.
    EXPECT_GE(stamped.time, kSteady + sent);
    EXPECT_LE(stamped.time, kSteady + sent + microseconds(35));
  }
}

/// A frame every 20 ms for 20 s, read `waited` after it. CLOCK_REALTIME is set `step` ahead while
/// the frame number `frame` waits in the socket.
Duration largest_error(Duration step, int frame, Duration waited, bool with_hardware) {
  ReceiveClock clock;
  Duration largest{};
  for (int i = 0; i < 1000; ++i) {
    const Duration sent = milliseconds(20 * i);
    KernelStamps stamps{.software = kRealtime + sent + (i > frame ? step : Duration::zero())};
    if (with_hardware) stamps.hardware = seconds(7) + sent;
    auto now = now_after(sent + waited);
    if (i >= frame) now.realtime += step;
    const Duration error = clock.to_steady(stamps, now).time - (kSteady + sent);
    largest = std::max<Duration>(largest, std::chrono::abs(error));
  }
  return largest;
}

TEST(ReceiveClock, AStepOfTheRealtimeClockChangesNoTime) {
  for (const bool with_hardware : {false, true}) {
    for (const Duration step :
         {Duration(milliseconds(900)), Duration(milliseconds(-900)), Duration(milliseconds(30)),
          Duration(seconds(3)), Duration(seconds(-3600)), Duration(seconds(3600))}) {
      EXPECT_LE(largest_error(step, 500, milliseconds(2), with_hardware), Duration(milliseconds(1)))
          << to_seconds(step) << " s, hardware stamps: " << with_hardware;
    }
  }
}

TEST(ReceiveClock, FramesThatWaitedDuringAStepKeepTheirTimes) {
  ReceiveClock clock;
  clock.to_steady({.software = kRealtime}, now_after(milliseconds(1)));
  auto now = now_after(milliseconds(120));
  now.realtime += milliseconds(900);
  for (const int sent_ms : {20, 40, 60}) {  // stamped before the step, read after it
    const auto stamped = clock.to_steady({.software = kRealtime + milliseconds(sent_ms)}, now);
    EXPECT_EQ(stamped.time, kSteady + milliseconds(sent_ms));
  }
  const auto after = clock.to_steady({.software = kRealtime + milliseconds(1000)}, now);
  EXPECT_EQ(after.time, kSteady + milliseconds(100));
}

TEST(ReceiveClock, FollowsADriftingController) {
  ReceiveClock clock;
  Time last{};
  for (int i = 0; i < 1000; ++i) {
    const Duration passed = milliseconds(100 * i);
    // The controller is 50 ppm slow, so it is 5 ms behind after 100 s.
    const nanoseconds hardware = seconds(7) + passed - passed / 20'000;
    last =
        clock.to_steady({.software = kRealtime + passed, .hardware = hardware}, now_after(passed))
            .time;
    EXPECT_LE(kSteady + passed - last, Duration(microseconds(20)));
  }
}

/// A frame every 20 ms for 200 s. CLOCK_MONOTONIC and CLOCK_REALTIME run faster than the
/// controller's clock by `rate`. Returns how far a time is behind the kernel's stamp at most.
Duration largest_lag(double rate) {
  ReceiveClock clock;
  Duration largest{};
  for (int i = 0; i < 10'000; ++i) {
    const Duration sent = milliseconds(20 * i);
    const Duration passed = from_seconds(to_seconds(sent) * (1.0 + rate));
    const auto stamped = clock.to_steady(
        {.software = kRealtime + passed, .hardware = seconds(7) + sent}, now_after(passed));
    EXPECT_EQ(stamped.source, StampSource::kHardware);
    largest = std::max(largest, kSteady + passed - stamped.time);
  }
  return largest;
}

TEST(ReceiveClock, FollowsAClockThatATimeServiceSteers) {
  for (const double rate : {500e-6, -500e-6}) {
    EXPECT_LE(largest_lag(rate), Duration(milliseconds(1))) << rate;
  }
  EXPECT_LE(largest_lag(0.01), Duration(milliseconds(3)));
}

TEST(ReceiveClock, FollowsAControllerWhoseClockStoodStill) {
  ReceiveClock clock;
  clock.to_steady({.software = kRealtime, .hardware = seconds(500)}, now_after(Duration::zero()));
  const auto stamped = clock.to_steady(
      {.software = kRealtime + milliseconds(110), .hardware = seconds(500) + milliseconds(10)},
      now_after(milliseconds(110)));
  EXPECT_EQ(stamped.time, kSteady + milliseconds(110));
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
