// Which values of several messages DbcVehicleInput combines.
#include <tuple>

#include <gtest/gtest.h>

#include "can/vehicle/dbc_vehicle_input.h"
#include "tests/can/vehicle/bound_vehicle.h"

namespace bevloc::can {
namespace {

using test::binding;
using test::binding_of_two_messages;
using test::frame_with;
using test::kCycle;
using test::kPage;
using test::kSpeed;
using test::kYawRate;

TEST(DbcSamplePairingTest, ALostFrameCostsOneSampleAndShiftsNoPair) {
  for (const uint32_t lost : {16U, 17U}) {
    for (const int later_ms : {2, 7}) {
      DbcVehicleInput input(binding_of_two_messages(), {}, {49.0, 8.4}, 1.6);
      int samples = 0;
      for (int cycle = 1; cycle <= 100; ++cycle) {
        const Time due(cycle * kCycle);
        const ReceivedFrame frames[] = {
            {frame_with(16, kSpeed, 0.1 * cycle), due},
            {frame_with(17, kYawRate, 0.001 * cycle), due + std::chrono::milliseconds(later_ms)}};
        for (const ReceivedFrame& received : frames) {
          if (cycle == 50 && received.frame.id == lost) continue;
          const auto sample = input.accept(received).odometry;
          if (!sample) continue;
          ++samples;
          EXPECT_EQ(sample->time, due) << lost << ", " << cycle;
          EXPECT_NEAR(sample->speed_mps, 0.1 * cycle, 1e-9);
          EXPECT_NEAR(sample->yaw_rate_radps, 0.001 * cycle, 1e-9);
        }
      }
      EXPECT_EQ(samples, 99) << lost << ", " << later_ms << " ms";
    }
  }
}

TEST(DbcSamplePairingTest, ThreeMessagesMayComeAtAnyTimeOfTheCycle) {
  VehicleBinding three = binding_of_two_messages();
  three.messages.push_back(three.messages[0]);
  three.messages[2].id = 18;
  three.signals.push_back(three.signals[0]);
  three.signals.back().message = 2;
  three.wheels.wheels = {{0, WheelPlace::kRearLeft}, {4, WheelPlace::kRearRight}};
  DbcVehicleInput input(three, {}, {49.0, 8.4}, 1.6);
  for (int cycle = 1; cycle <= 100; ++cycle) {
    for (const int third : {0, 1, 2}) {
      const Frame frame{.id = 16 + static_cast<uint32_t>(third), .length = 8};
      input.accept({frame, Time(cycle * kCycle + third * kCycle / 3)});
    }
  }
  EXPECT_EQ(input.counters().odometry_samples, 100U);
  EXPECT_EQ(input.counters().incomplete, 0U);
}

constexpr SignalLayout kFineValue{0, 32, ByteOrder::kIntel, RawType::kSigned, 1e-7, 0.0};
constexpr Duration kPositionCycle = std::chrono::milliseconds(100);

/// binding() and a position: latitude, longitude and sigma in the messages 17, 18 and 19. The sigma
/// comes with every tenth position.
VehicleBinding binding_with_slow_sigma() {
  VehicleBinding all = binding();
  for (const auto& [id, cycle, layout] : {std::tuple(17U, kPositionCycle, kFineValue),
                                          {18U, kPositionCycle, kFineValue},
                                          {19U, 10 * kPositionCycle, kFineValue}}) {
    all.messages.push_back({.name = "B", .id = id, .length = 8, .cycle = cycle, .protection = {}});
    all.signals.push_back({.name = "S",
                           .message = all.messages.size() - 1,
                           .layout = layout,
                           .available = {-500.0, 500.0}});
  }
  all.gnss = {.latitude = 4, .longitude = 5, .sigma_north = 6, .sigma_east = 6};
  return all;
}

TEST(DbcSamplePairingTest, APositionIsThatOfOneCycleBesideASlowSigma) {
  DbcVehicleInput input(binding_with_slow_sigma(), {}, {49.0, 8.4}, 1.6);
  int samples = 0;
  for (int cycle = 1; cycle <= 60; ++cycle) {
    const Time due(cycle * kPositionCycle);
    const auto send = [&](const Frame& frame, int later_ms) {
      const Time received = due + std::chrono::milliseconds(later_ms);
      const auto sample = input.accept({frame, received}).gnss;
      if (!sample) return;
      ++samples;
      EXPECT_EQ(sample->time, due) << cycle;
      EXPECT_NEAR(sample->north_m, 11.12 * cycle, 1.0);
      EXPECT_NEAR(sample->east_m, 7.32 * cycle, 1.0);
      EXPECT_NEAR(sample->sigma_east_m, 1.5, 1e-9);
    };
    if (cycle != 20) send(frame_with(17, kFineValue, 49.0 + 1e-4 * cycle), 0);
    if (cycle % 10 == 0) send(frame_with(19, kFineValue, 1.5), 1);
    send(frame_with(18, kFineValue, 8.4 + 1e-4 * cycle), 2);
  }
  EXPECT_EQ(samples, 6) << "one for each sigma";
}

/// Returns the number of positions from 200 frames. A message carries one page after the other, as
/// many as `pages`. Page 0 has the latitude, and `longitude_page` has the longitude.
uint64_t positions_of_pages(int pages, int longitude_page) {
  VehicleBinding paged = binding();
  paged.messages.push_back(
      {.name = "B", .id = 17, .length = 8, .cycle = kPositionCycle, .protection = {}});
  for (const int page : {0, longitude_page}) {
    paged.signals.push_back(
        {.name = "S",
         .message = 1,
         .layout = kFineValue,
         .multiplexed = BoundSignal::Multiplexed{kPage, static_cast<uint64_t>(page)},
         .available = {-500.0, 500.0}});
  }
  paged.gnss = {.latitude = 4, .longitude = 5, .sigma_m = 1.0};
  DbcVehicleInput input(paged, {}, {49.0, 8.4}, 1.6);
  for (int cycle = 1; cycle <= 200; ++cycle) {
    const int page = cycle % pages;
    Frame frame = frame_with(17, kFineValue, page == 0 ? 49.0 : 8.4);
    insert_bits(kPage, static_cast<uint64_t>(page), {frame.data.data(), frame.length});
    input.accept({frame, Time(cycle * kPositionCycle)});
  }
  return input.counters().gnss_samples;
}

TEST(DbcSamplePairingTest, PagesOfOneMessageGiveAPosition) {
  EXPECT_GT(positions_of_pages(2, 1), 90U);
  EXPECT_GT(positions_of_pages(10, 5), 15U) << "one a second";
}

/// A message carries one page after the other: latitude, longitude, heading, and then others. The
/// pages with the longitude come later by `jitter`.
void expect_headings_of_their_round(int pages, Duration jitter) {
  VehicleBinding paged = binding();
  paged.messages.push_back(
      {.name = "B", .id = 17, .length = 8, .cycle = kPositionCycle, .protection = {}});
  for (const uint64_t page : {0, 1, 2}) {
    paged.signals.push_back({.name = "S",
                             .message = 1,
                             .layout = kFineValue,
                             .multiplexed = BoundSignal::Multiplexed{kPage, page},
                             .available = {-500.0, 500.0}});
  }
  paged.gnss = {.latitude = 4, .longitude = 5, .sigma_m = 1.0, .heading = 6};
  paged.gnss->sigma_heading_deg = 1.0;
  DbcVehicleInput input(paged, {}, {49.0, 8.4}, 1.6);
  int samples = 0;
  constexpr int kRounds = 20;
  for (int frame_number = 0; frame_number < kRounds * pages; ++frame_number) {
    const int round = frame_number / pages;
    const int page = frame_number % pages;
    const Time due(frame_number * kPositionCycle);
    const double values[] = {49.0, 8.4, 1.0 * round};
    Frame frame = frame_with(17, kFineValue, page < 3 ? values[page] : 0.0);
    insert_bits(kPage, static_cast<uint64_t>(page), {frame.data.data(), frame.length});
    const auto sample = input.accept({frame, page == 1 ? due + jitter : due}).gnss;
    // The periods of the signals are known after the second round.
    if (!sample || round < 2) continue;
    ++samples;
    EXPECT_EQ(page, 2) << pages << " pages, round " << round;
    EXPECT_EQ(sample->time, Time(round * pages * kPositionCycle));
    ASSERT_TRUE(sample->yaw) << pages << " pages, round " << round;
    EXPECT_NEAR(degrees(sample->yaw->yaw_rad), 90.0 - round, 1e-3) << pages << " pages";
  }
  EXPECT_EQ(samples, kRounds - 2) << pages << " pages";
}

TEST(DbcSamplePairingTest, AHeadingOnAPageIsThatOfItsPosition) {
  for (const int pages : {3, 5, 6, 7, 12}) {
    for (const Duration jitter : {Duration(std::chrono::milliseconds(-1)), Duration(0),
                                  Duration(std::chrono::milliseconds(1))}) {
      expect_headings_of_their_round(pages, jitter);
    }
  }
}

/// One of eight frames says whether the vehicle reverses.
TEST(DbcSamplePairingTest, AConditionMayComeWithOnePageOfMany) {
  VehicleBinding paged = binding();
  paged.signals[paged.wheels.backward->signal].multiplexed = BoundSignal::Multiplexed{kPage, 1};
  DbcVehicleInput input(paged, {}, {49.0, 8.4}, 1.6);
  const auto send = [&](int cycle) {
    Frame frame = frame_with(16, kSpeed, 2.0);
    insert_bits(kPage, static_cast<uint64_t>(cycle % 8), {frame.data.data(), frame.length});
    return input.accept({frame, Time(cycle * kCycle)}).odometry;
  };
  for (int cycle = 1; cycle <= 10; ++cycle) send(cycle);  // 200 ms
  const uint64_t before = input.counters().not_available;
  for (int cycle = 11; cycle <= 500; ++cycle) EXPECT_TRUE(send(cycle)) << cycle;
  EXPECT_EQ(input.counters().not_available, before);
}

TEST(DbcSamplePairingTest, AConditionOfASeldomPageHoldsForTwoSeconds) {
  VehicleBinding paged = binding();
  paged.signals[paged.wheels.backward->signal].multiplexed = BoundSignal::Multiplexed{kPage, 1};
  DbcVehicleInput input(paged, {}, {49.0, 8.4}, 1.6);
  const auto send = [&](int cycle, bool has_condition) {
    Frame frame = frame_with(16, kSpeed, 2.0);
    insert_bits(kPage, has_condition ? 1 : 0, {frame.data.data(), frame.length});
    return input.accept({frame, Time(cycle * kCycle)}).odometry.has_value();
  };
  constexpr int kSecond = 50;
  for (int cycle = 1; cycle <= 5 * kSecond; ++cycle) send(cycle, cycle % kSecond == 0);
  // The page no longer comes.
  int samples = 0;
  for (int cycle = 1; cycle <= 10 * kSecond; ++cycle) samples += send(5 * kSecond + cycle, false);
  EXPECT_EQ(samples, 2 * kSecond);
}

}  // namespace
}  // namespace bevloc::can
