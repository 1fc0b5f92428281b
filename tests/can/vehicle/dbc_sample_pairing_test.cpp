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

TEST(DbcSamplePairingTest, PagesOfOneMessageGiveAPosition) {
  VehicleBinding paged = binding();
  paged.messages.push_back(
      {.name = "B", .id = 17, .length = 8, .cycle = kPositionCycle, .protection = {}});
  for (const uint64_t page : {1, 2}) {
    paged.signals.push_back({.name = "S",
                             .message = 1,
                             .layout = kFineValue,
                             .multiplexed = BoundSignal::Multiplexed{kPage, page},
                             .available = {-500.0, 500.0}});
  }
  paged.gnss = {.latitude = 4, .longitude = 5, .sigma_m = 1.0};
  DbcVehicleInput input(paged, {}, {49.0, 8.4}, 1.6);
  for (int cycle = 1; cycle <= 40; ++cycle) {
    const bool is_latitude = cycle % 2 == 1;
    Frame frame = frame_with(17, kFineValue, is_latitude ? 49.0 : 8.4);
    insert_bits(kPage, is_latitude ? 1 : 2, {frame.data.data(), frame.length});
    input.accept({frame, Time(cycle * kPositionCycle)});
  }
  EXPECT_GT(input.counters().gnss_samples, 15U);
}

}  // namespace
}  // namespace bevloc::can
