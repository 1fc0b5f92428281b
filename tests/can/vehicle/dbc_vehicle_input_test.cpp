#include "can/vehicle/dbc_vehicle_input.h"

#include <variant>

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

constexpr SignalLayout kSpeed{0, 16, ByteOrder::kIntel, RawType::kSigned, 0.01, 0.0};
constexpr SignalLayout kYawRate{16, 16, ByteOrder::kIntel, RawType::kSigned, 0.001, 0.0};
constexpr SignalLayout kReverse{32, 1};
constexpr SignalLayout kRight{33, 1};

/// A message with a speed and a yaw rate that have signs, and beside them a gear and a direction.
VehicleBinding binding() {
  VehicleBinding binding;
  binding.messages = {{.name = "A",
                       .id = 16,
                       .length = 8,
                       .cycle = std::chrono::milliseconds(20),
                       .protection = {},
                       .has_odometry = true}};
  for (const SignalLayout& layout : {kSpeed, kYawRate, kReverse, kRight}) {
    binding.signals.push_back({.name = "S", .layout = layout, .min = -500.0, .max = 500.0});
  }
  binding.wheels.wheels = {{0, WheelPlace::kVehicle}};
  binding.wheels.backward = BoundCondition{2, {1}};
  binding.yaw_rate = {.signal = 1, .negative = BoundCondition{3, {1}}};
  return binding;
}

OdometrySample sample_of(double speed_mps, bool reverse, double yaw_rate_radps, bool right) {
  DbcVehicleInput input(binding(), {}, {49.0, 8.4}, {});
  Frame frame{.id = 16, .length = 8};
  const std::span<uint8_t> bytes(frame.data.data(), frame.length);
  insert_physical(kSpeed, speed_mps, bytes);
  insert_physical(kYawRate, yaw_rate_radps, bytes);
  insert_bits(kReverse, reverse ? 1 : 0, bytes);
  insert_bits(kRight, right ? 1 : 0, bytes);
  std::optional<VehicleSample> sample;
  for (int cycle = 0; cycle < 20 && !sample; ++cycle) {
    sample = input.accept({frame, Time(std::chrono::milliseconds(20 * (cycle + 1)))});
  }
  EXPECT_TRUE(sample);
  return sample ? std::get<OdometrySample>(*sample) : OdometrySample{};
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

}  // namespace
}  // namespace bevloc::can
