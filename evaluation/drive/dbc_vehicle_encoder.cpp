#include "evaluation/drive/dbc_vehicle_encoder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "can/vehicle/wheel_fusion.h"

namespace bevloc::evaluation {
namespace {

/// A raw value that is none of `values`.
int64_t other_value(const std::vector<int64_t>& values) {
  int64_t other = 0;
  while (std::ranges::find(values, other) != values.end()) ++other;
  return other;
}

can::Frame empty_frame(const can::BoundMessage& message) {
  const bool fd = message.length > can::kMaxClassicLength;
  return {.id = message.id,
          .length = message.length,
          .data = {},
          .format = fd ? can::FrameFormat::kFd : can::FrameFormat::kClassic};
}

}  // namespace

DbcVehicleEncoder::DbcVehicleEncoder(const can::VehicleBinding& binding,
                                     can::GeodeticPosition map_origin, double rear_track_m)
    : binding_(binding),
      geo_(map_origin),
      rear_track_m_(rear_track_m),
      counters_(binding.messages.size()) {}

void DbcVehicleEncoder::set(size_t signal, double value) {
  values_.push_back({signal, value / binding_.signals[signal].factor});
}

void DbcVehicleEncoder::set(const std::optional<can::BoundCondition>& condition, bool holds) {
  if (!condition) return;
  const int64_t raw = holds ? condition->values.front() : other_value(condition->values);
  const can::SignalLayout& layout = binding_.signals[condition->signal].layout;
  values_.push_back({condition->signal, static_cast<double>(raw) * layout.scale + layout.offset});
}

std::span<const can::Frame> DbcVehicleEncoder::odometry(const can::WheelOdometry& measured) {
  values_.clear();
  const can::BoundWheels& moving = binding_.wheels;
  const double speed_mps = 0.5 * (measured.left_mps + measured.right_mps);
  const bool reverses = moving.backward && speed_mps < 0.0;
  const can::WheelFusion front(rear_track_m_, moving.wheelbase_m, measured.front_yaw_rate_radps);
  for (const can::BoundWheels::Wheel& wheel : moving.wheels) {
    double wheel_mps = front.wheel_speed(wheel.place, measured.front_speed_mps);
    if (wheel.place == can::WheelPlace::kRearLeft) wheel_mps = measured.left_mps;
    if (wheel.place == can::WheelPlace::kRearRight) wheel_mps = measured.right_mps;
    if (wheel.place == can::WheelPlace::kVehicle) wheel_mps = speed_mps;
    set(wheel.signal, reverses ? -wheel_mps : wheel_mps);
  }
  set(moving.valid, true);
  set(moving.backward, reverses);
  const can::BoundYawRate& turning = binding_.yaw_rate;
  double yaw_rate_radps = measured.yaw_rate_radps;
  if (turning.positive_right) yaw_rate_radps = -yaw_rate_radps;
  const bool negative = turning.negative && yaw_rate_radps < 0.0;
  set(turning.signal, negative ? -yaw_rate_radps : yaw_rate_radps);
  set(turning.valid, true);
  set(turning.negative, negative);
  return frames();
}

std::span<const can::Frame> DbcVehicleEncoder::odometry(const OdometrySample& sample) {
  const can::WheelFusion axle(rear_track_m_, binding_.wheels.wheelbase_m, sample.yaw_rate_radps);
  return odometry(can::WheelOdometry{
      .left_mps = axle.wheel_speed(can::WheelPlace::kRearLeft, sample.speed_mps),
      .right_mps = axle.wheel_speed(can::WheelPlace::kRearRight, sample.speed_mps),
      .yaw_rate_radps = sample.yaw_rate_radps,
      .front_speed_mps = sample.speed_mps,
      .front_yaw_rate_radps = sample.yaw_rate_radps});
}

std::span<const can::Frame> DbcVehicleEncoder::gnss(const GnssSample& sample) {
  values_.clear();
  frames_.clear();
  if (!binding_.gnss) return frames_;
  const can::BoundGnss& gnss = *binding_.gnss;
  const double yaw_rad = sample.yaw ? sample.yaw->yaw_rad : 0.0;
  const can::GeodeticPose pose = geo_.geodetic_from_map({sample.east_m, sample.north_m, yaw_rad});
  set(gnss.latitude, pose.position.latitude_deg);
  set(gnss.longitude, pose.position.longitude_deg);
  set(gnss.valid, true);
  if (gnss.sigma_north) set(*gnss.sigma_north, sample.sigma_north_m);
  if (gnss.sigma_east && gnss.sigma_east != gnss.sigma_north) {
    set(*gnss.sigma_east, sample.sigma_east_m);
  }
  if (gnss.heading) set(*gnss.heading, pose.heading_deg);
  set(gnss.heading_valid, sample.yaw.has_value());
  if (gnss.sigma_heading) {
    set(*gnss.sigma_heading, sample.yaw ? degrees(sample.yaw->sigma_rad) : 0.0);
  }
  return frames();
}

std::span<const can::Frame> DbcVehicleEncoder::frames() {
  frames_.clear();
  for (size_t message = 0; message < binding_.messages.size(); ++message) add_frames(message);
  return frames_;
}

/// Adds a frame of the message for each value of its multiplexor that the values need.
void DbcVehicleEncoder::add_frames(size_t message) {
  std::set<std::optional<uint64_t>> pages;
  for (const Value& value : values_) {
    const can::BoundSignal& signal = binding_.signals[value.signal];
    if (signal.message != message) continue;
    pages.insert(signal.multiplexed ? std::optional(signal.multiplexed->value) : std::nullopt);
  }
  if (pages.size() > 1) pages.erase(std::nullopt);
  for (const auto& page : pages) {
    can::Frame frame = empty_frame(binding_.messages[message]);
    const std::span<uint8_t> bytes(frame.data.data(), frame.length);
    for (const Value& value : values_) {
      const can::BoundSignal& signal = binding_.signals[value.signal];
      const bool on_page = !signal.multiplexed || signal.multiplexed->value == page;
      if (signal.message != message || !on_page) continue;
      if (page && signal.multiplexed) {
        can::insert_bits(signal.multiplexed->multiplexor, *page, bytes);
      }
      can::insert_physical(signal.layout, value.physical, bytes);
    }
    const can::MessageProtection& protection = binding_.messages[message].protection;
    const int highest =
        protection.checksum == can::ChecksumKind::kE2eP05 ? UINT8_MAX : protection.highest_counter;
    can::protect(frame, protection, counters_[message]);
    counters_[message] =
        static_cast<uint8_t>(counters_[message] >= highest ? 0 : counters_[message] + 1);
    frames_.push_back(frame);
  }
}

}  // namespace bevloc::evaluation
