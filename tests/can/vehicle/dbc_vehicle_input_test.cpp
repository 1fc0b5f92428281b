#include "can/vehicle/dbc_vehicle_input.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/se2.h"
#include "pipeline/tracker/odometry_monitor.h"
#include "tests/can/vehicle/bound_vehicle.h"

namespace bevloc::can {
namespace {

using test::binding;
using test::binding_of_two_messages;
using test::frame_with;
using test::kCycle;
using test::kPage;
using test::kReverse;
using test::kRight;
using test::kSpeed;
using test::kYawRate;

OdometrySample sample_of(double speed_mps, bool reverse, double yaw_rate_radps, bool right) {
  DbcVehicleInput input(binding(), {}, {49.0, 8.4}, 1.6);
  Frame frame{.id = 16, .length = 8};
  const std::span<uint8_t> bytes(frame.data.data(), frame.length);
  insert_physical(kSpeed, speed_mps, bytes);
  insert_physical(kYawRate, yaw_rate_radps, bytes);
  insert_bits(kReverse, reverse ? 1 : 0, bytes);
  insert_bits(kRight, right ? 1 : 0, bytes);
  std::optional<OdometrySample> sample;
  for (int cycle = 0; cycle < 20 && !sample; ++cycle) {
    sample = input.accept({frame, Time(std::chrono::milliseconds(20 * (cycle + 1)))}).odometry;
  }
  EXPECT_TRUE(sample);
  return sample.value_or(OdometrySample{});
}

TEST(DbcVehicleInputTest, AConditionGivesTheSignOfAMagnitude) {
  const OdometrySample ahead = sample_of(2.0, false, 0.1, false);
  EXPECT_NEAR(ahead.speed_mps, 2.0, 1e-9);
  EXPECT_NEAR(ahead.yaw_rate_radps, 0.1, 1e-9);
  const OdometrySample back = sample_of(2.0, true, 0.1, true);
  EXPECT_NEAR(back.speed_mps, -2.0, 1e-9);
  EXPECT_NEAR(back.yaw_rate_radps, -0.1, 1e-9);
}

TEST(DbcVehicleInputTest, ASignalWithASignKeepsItBesideTheCondition) {
  const OdometrySample back = sample_of(-2.0, true, -0.1, true);
  EXPECT_NEAR(back.speed_mps, -2.0, 1e-9);
  EXPECT_NEAR(back.yaw_rate_radps, -0.1, 1e-9);
}

TEST(DbcVehicleInputTest, ADirectionThatIsNotAvailableGivesNoSample) {
  constexpr SignalLayout kGear{34, 4};
  VehicleBinding with_gear = binding();
  with_gear.signals[2] = {.name = "Gear", .layout = kGear, .available = {0.0, 5.0, {15}}};
  VehicleBinding with_direction = with_gear;
  with_direction.wheels.backward.reset();
  with_direction.yaw_rate.negative = BoundCondition{2, {1}};
  for (const VehicleBinding& bound : {with_gear, with_direction}) {
    for (const auto& [gear, is_available] :
         {std::pair(0, true), {1, true}, {9, false}, {15, false}}) {
      DbcVehicleInput input(bound, {}, {49.0, 8.4}, 1.6);
      Frame frame{.id = 16, .length = 8};
      insert_bits(kGear, static_cast<uint64_t>(gear), {frame.data.data(), frame.length});
      for (int cycle = 1; cycle <= 50; ++cycle) {
        input.accept({frame, Time(std::chrono::milliseconds(20 * cycle))});
      }
      EXPECT_EQ(input.counters().odometry_samples > 0, is_available) << gear;
      EXPECT_EQ(input.counters().not_available > 0, !is_available) << gear;
    }
  }
}

TEST(DbcVehicleInputTest, OdometryWithoutOneOfItsMessagesIsCounted) {
  DbcVehicleInput input(binding_of_two_messages(), {}, {49.0, 8.4}, 1.6);
  const auto send = [&](uint32_t id, int cycle) {
    input.accept({{.id = id, .length = 8}, Time(std::chrono::milliseconds(20 * cycle))});
  };
  for (int cycle = 1; cycle <= 50; ++cycle) {
    send(16, cycle);
    send(17, cycle);
  }
  const uint64_t samples = input.counters().odometry_samples;
  EXPECT_GT(samples, 40U);
  EXPECT_EQ(input.counters().incomplete, 0U);
  for (int cycle = 51; cycle <= 100; ++cycle) send(16, cycle);
  EXPECT_EQ(input.counters().odometry_samples, samples);
  // The first message waits, and four cycles pass before the other message counts as missing.
  EXPECT_EQ(input.counters().incomplete, 46U);
}

TEST(DbcVehicleInputTest, TheSpeedOfTheVehicleAloneSaysNothingAboutTheYawRate) {
  DbcVehicleInput input(binding(), {}, {49.0, 8.4}, 1.6);
  Frame frame = frame_with(16, kSpeed, 14.0);
  insert_physical(kYawRate, 0.1, {frame.data.data(), frame.length});
  for (int cycle = 1; cycle <= 1500; ++cycle) {
    const auto sample = input.accept({frame, Time(cycle * kCycle)}).odometry;
    ASSERT_TRUE(sample);
    ASSERT_FALSE(sample->wheel_lean) << cycle;
  }
}

/// A sample comes every 40 ms: the message has this cycle, or only every second frame carries the
/// yaw rate.
TEST(DbcVehicleInputTest, TwoLostFramesOfSlowOdometryAreNoFault) {
  VehicleBinding slow = binding();
  slow.messages[0].cycle = 2 * kCycle;
  VehicleBinding paged = binding();
  paged.signals[1].multiplexed = BoundSignal::Multiplexed{kPage, 1};
  Frame frame = frame_with(16, kSpeed, 2.0);
  insert_bits(kPage, 1, {frame.data.data(), frame.length});
  for (const VehicleBinding& bound : {slow, paged}) {
    DbcVehicleInput input(bound, {}, {49.0, 8.4}, 1.6);
    for (int sample = 1; sample <= 100; ++sample) {
      if (sample != 50 && sample != 51) input.accept({frame, Time(sample * 2 * kCycle)});
    }
    EXPECT_EQ(input.counters().odometry_samples, 98U);
    EXPECT_FALSE(input.fault_times().implausible);
  }
}

VehicleBinding binding_with_steps(double speed_mps, double yaw_rate_radps) {
  VehicleBinding with_steps = binding();
  with_steps.signals[0].layout.scale = speed_mps;
  with_steps.signals[1].layout.scale = yaw_rate_radps;
  return with_steps;
}

/// Returns how many samples of a minute OdometryMonitor refuses. If the sensors stick, both values
/// stay the same from the middle of the minute on.
int refused_in_a_minute(const VehicleBinding& bound, bool sensors_stick) {
  DbcVehicleInput input(bound, {}, {49.0, 8.4}, 1.6);
  OdometryMonitor monitor;
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  Frame frame;
  int refused = 0;
  for (int cycle = 1; cycle <= 3000; ++cycle) {
    const double time_s = to_seconds(cycle * kCycle);
    if (cycle <= 1500 || !sensors_stick) {
      const double speed_mps = 14.0 + 2.0 * std::sin(0.2 * time_s) + 0.04 * noise(random);
      const double yaw_rate_radps = 0.1 * std::sin(0.3 * time_s) + 0.002 * noise(random);
      frame = frame_with(16, bound.signals[0].layout, speed_mps);
      insert_physical(bound.signals[1].layout, yaw_rate_radps, {frame.data.data(), frame.length});
    }
    const auto sample = input.accept({frame, Time(cycle * kCycle)}).odometry;
    refused += sample && monitor.accept(*sample) ? 0 : 1;
  }
  return refused;
}

TEST(DbcVehicleInputTest, ValuesWithCoarseStepsMayRepeat) {
  const VehicleBinding coarse = binding_with_steps(0.28, 0.02);
  EXPECT_EQ(refused_in_a_minute(coarse, false), 0);
  EXPECT_EQ(refused_in_a_minute(binding(), false), 0);
  const size_t other_warnings = warnings_of(binding()).size();
  EXPECT_EQ(warnings_of(coarse).size(), other_warnings + 1);
  // The fine steps of one value suffice to notice that the sensors are stuck.
  for (const VehicleBinding& fine :
       {binding(), binding_with_steps(0.28, 0.0005), binding_with_steps(0.01, 0.02)}) {
    EXPECT_GT(refused_in_a_minute(fine, true), 1400);
    EXPECT_EQ(warnings_of(fine).size(), other_warnings);
  }
}

constexpr SignalLayout kLatitude{64, 32, ByteOrder::kIntel, RawType::kSigned, 1e-7, 0.0};
constexpr SignalLayout kLongitude{96, 32, ByteOrder::kIntel, RawType::kSigned, 1e-7, 0.0};
constexpr SignalLayout kHeading{0, 16, ByteOrder::kIntel, RawType::kUnsigned, 0.01, 0.0};
constexpr SignalLayout kSigma{16, 16, ByteOrder::kIntel, RawType::kUnsigned, 0.01, 0.0};

/// The message of binding() carries a position too. Two other messages carry the heading and its
/// sigma.
VehicleBinding binding_with_gnss() {
  VehicleBinding all = binding();
  all.messages[0].length = 16;
  for (const uint32_t id : {17U, 18U}) {
    all.messages.push_back({.name = "B",
                            .id = id,
                            .length = 4,
                            .cycle = std::chrono::milliseconds(100),
                            .protection = {}});
  }
  const auto add = [&](size_t message, const SignalLayout& layout) {
    all.signals.push_back(
        {.name = "S", .message = message, .layout = layout, .available = {-500.0, 500.0}});
    return all.signals.size() - 1;
  };
  all.gnss = {.latitude = add(0, kLatitude), .longitude = add(0, kLongitude), .sigma_m = 1.0};
  all.gnss->heading = add(1, kHeading);
  all.gnss->sigma_heading = add(2, kSigma);
  return all;
}

/// Long enough for a message to become valid.
constexpr int kSettlingCycles = 100;

/// The vehicle of binding_with_gnss().
class GnssVehicle {
 public:
  explicit GnssVehicle(VehicleBinding binding) : input_(std::move(binding), {}, {49.0, 8.4}, 1.6) {}

  VehicleSamples send_motion_and_position(Time now) {
    Frame frame{.id = 16, .length = 16};
    const std::span<uint8_t> bytes(frame.data.data(), frame.length);
    insert_physical(kSpeed, 2.0, bytes);
    insert_physical(kLatitude, 49.001, bytes);
    insert_physical(kLongitude, 8.401, bytes);
    return input_.accept({frame, now});
  }
  VehicleSamples send_heading(uint32_t id, Time now) {
    return input_.accept({{.id = id, .length = 4}, now});
  }
  void send_headings(Time now) {
    send_heading(17, now);
    send_heading(18, now);
  }
  /// Sends all messages on their cycles until they are valid. Returns the time of the latest ones.
  Time settle() {
    for (int cycle = 1; cycle <= kSettlingCycles; ++cycle) {
      send_motion_and_position(Time(cycle * kCycle));
      if (cycle % 5 == 0) send_headings(Time(cycle * kCycle));
    }
    return Time(kSettlingCycles * kCycle);
  }

 private:
  DbcVehicleInput input_;
};

TEST(DbcVehicleInputTest, OneMessageMayCarryOdometryAndGnss) {
  VehicleBinding together = binding_with_gnss();
  together.gnss->heading.reset();
  together.gnss->sigma_heading.reset();
  GnssVehicle vehicle(std::move(together));
  VehicleSamples samples;
  for (int cycle = 1; cycle <= kSettlingCycles; ++cycle) {
    samples = vehicle.send_motion_and_position(Time(cycle * kCycle));
  }
  ASSERT_TRUE(samples.odometry);
  EXPECT_NEAR(samples.odometry->speed_mps, 2.0, 1e-9);
  ASSERT_TRUE(samples.gnss);
  EXPECT_NEAR(samples.gnss->north_m, 111.2, 0.1);
  EXPECT_FALSE(samples.gnss->yaw);
}

TEST(DbcVehicleInputTest, AnOldHeadingIsNotThatOfAFreshPosition) {
  for (const uint32_t old : {17U, 18U}) {
    for (const bool comes_again : {false, true}) {
      GnssVehicle vehicle(binding_with_gnss());
      Time now = vehicle.settle();
      // The positions wait for the other message during four of its cycles, which are 20 of their
      // own. One cycle later they no longer wait for it.
      vehicle.send_heading(old, now);
      for (int cycle = 0; cycle < 20; ++cycle) {
        EXPECT_FALSE(vehicle.send_motion_and_position(now += kCycle).gnss);
      }
      EXPECT_FALSE(vehicle.send_heading(old == 17 ? 18 : 17, now).gnss) << "beside the old one";
      const VehicleSamples samples = comes_again ? vehicle.send_heading(old, now)
                                                 : vehicle.send_motion_and_position(now += kCycle);
      ASSERT_TRUE(samples.gnss) << old << ", " << comes_again;
      EXPECT_EQ(samples.gnss->yaw.has_value(), comes_again) << old;
    }
  }
}

TEST(DbcVehicleInputTest, PositionsDoNotNeedAHeadingThatStopped) {
  GnssVehicle vehicle(binding_with_gnss());
  Time now = vehicle.settle();
  int samples = 0;
  for (int cycle = 0; cycle < 50; ++cycle) {
    const auto sample = vehicle.send_motion_and_position(now += kCycle).gnss;
    if (!sample) continue;
    EXPECT_FALSE(sample->yaw);
    ++samples;
  }
  EXPECT_EQ(samples, 30) << "the first 20 cycles wait for the heading";
}

/// The sample of a message that carries odometry, a position, a heading and their sigmas in these
/// steps, if it gives one.
std::optional<GnssSample> sample_with_sigmas(double sigma_m, double sigma_deg, double step) {
  const SignalLayout position{128, 16, ByteOrder::kIntel, RawType::kSigned, step, 0.0};
  const SignalLayout heading{144, 16, ByteOrder::kIntel, RawType::kSigned, step, 0.0};
  VehicleBinding all = binding_with_gnss();
  all.messages[0].length = 24;
  for (const SignalLayout& layout : {position, heading}) {
    all.signals.push_back({.name = "S", .layout = layout});
  }
  all.gnss->sigma_north = all.gnss->sigma_east = all.signals.size() - 2;
  all.gnss->sigma_heading = all.signals.size() - 1;
  all.signals[*all.gnss->heading].message = 0;
  DbcVehicleInput input(all, {}, {49.0, 8.4}, 1.6);
  Frame frame{.id = 16, .length = 24};
  const std::span<uint8_t> bytes(frame.data.data(), frame.length);
  insert_physical(kLatitude, 49.001, bytes);
  insert_physical(kLongitude, 8.401, bytes);
  insert_physical(position, sigma_m, bytes);
  insert_physical(heading, sigma_deg, bytes);
  std::optional<GnssSample> sample;
  for (int cycle = 1; cycle <= kSettlingCycles; ++cycle) {
    sample = input.accept({frame, Time(cycle * kCycle)}).gnss;
  }
  return sample;
}

TEST(DbcVehicleInputTest, ASigmaIsAtLeastOneStepOfItsSignal) {
  const auto coarse = sample_with_sigmas(0.0, 0.0, 0.5);
  ASSERT_TRUE(coarse && coarse->yaw);
  EXPECT_DOUBLE_EQ(coarse->sigma_north_m, 0.5);
  EXPECT_DOUBLE_EQ(coarse->sigma_east_m, 0.5);
  EXPECT_NEAR(degrees(coarse->yaw->sigma_rad), 0.5, 1e-9);
  const auto fine = sample_with_sigmas(0.0, 0.0, 0.001);
  ASSERT_TRUE(fine && fine->yaw);
  EXPECT_DOUBLE_EQ(fine->sigma_north_m, 0.01) << "no measurement is exact";
  EXPECT_NEAR(degrees(fine->yaw->sigma_rad), 0.01, 1e-9);
  const auto larger = sample_with_sigmas(3.0, 2.0, 0.5);
  ASSERT_TRUE(larger && larger->yaw);
  EXPECT_DOUBLE_EQ(larger->sigma_north_m, 3.0);
  EXPECT_NEAR(degrees(larger->yaw->sigma_rad), 2.0, 1e-9);
}

TEST(DbcVehicleInputTest, ANegativeSigmaIsNotAvailable) {
  EXPECT_FALSE(sample_with_sigmas(-0.5, 1.0, 0.5));
  const auto without_heading = sample_with_sigmas(1.0, -0.5, 0.5);
  ASSERT_TRUE(without_heading);
  EXPECT_FALSE(without_heading->yaw);
}

}  // namespace
}  // namespace bevloc::can
