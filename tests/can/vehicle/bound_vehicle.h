// A vehicle with a bus of its own: its binding and its frames.
#pragma once

#include <cstdint>

#include "can/bus/frame.h"
#include "can/vehicle/vehicle_binding.h"

namespace bevloc::can::test {

inline constexpr SignalLayout kSpeed{0, 16, ByteOrder::kIntel, RawType::kSigned, 0.01, 0.0};
inline constexpr SignalLayout kYawRate{16, 16, ByteOrder::kIntel, RawType::kSigned, 0.001, 0.0};
inline constexpr SignalLayout kReverse{32, 1};
inline constexpr SignalLayout kRight{33, 1};
inline constexpr SignalLayout kPage{60, 4};
inline constexpr Duration kCycle = std::chrono::milliseconds(20);

/// A message with a speed and a yaw rate that have signs, and beside them a gear and a direction.
inline VehicleBinding binding() {
  VehicleBinding binding;
  binding.messages = {{.name = "A",
                       .id = 16,
                       .length = 8,
                       .cycle = std::chrono::milliseconds(20),
                       .protection = {},
                       .has_odometry = true}};
  for (const SignalLayout& layout : {kSpeed, kYawRate, kReverse, kRight}) {
    binding.signals.push_back({.name = "S", .layout = layout, .available = {-500.0, 500.0}});
  }
  binding.wheels.wheels = {{0, WheelPlace::kVehicle}};
  binding.wheels.backward = BoundCondition{2, {1}};
  binding.yaw_rate = {.signal = 1, .negative = BoundCondition{3, {1}}};
  return binding;
}

/// The message of binding() in two parts: 16 with the speed, and 17 with the yaw rate.
inline VehicleBinding binding_of_two_messages() {
  VehicleBinding apart = binding();
  apart.messages.push_back(apart.messages[0]);
  apart.messages[1].id = 17;
  apart.signals[1].message = 1;
  return apart;
}

/// A frame in which only this signal is not 0.
inline Frame frame_with(uint32_t id, const SignalLayout& layout, double value) {
  Frame frame{.id = id, .length = 8};
  insert_physical(layout, value, {frame.data.data(), frame.length});
  return frame;
}

}  // namespace bevloc::can::test
