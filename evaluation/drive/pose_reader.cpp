#include "evaluation/drive/pose_reader.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "can/publisher/solution_fd.h"

namespace bevloc::evaluation {
namespace {

can::E2eChecker checker_of(const can::Message& message) {
  return {message.protection(), message.length};
}

int64_t epoch_of(const can::Frame& frame) {
  return can::extract_raw(frame, can::kEpoch);
}

/// Inserts the reasons of `flags` into the bits from `first_bit` on.
uint32_t why_bits(const can::Frame& frame, std::span<const can::Signal> flags, int first_bit) {
  uint32_t bits = 0;
  for (size_t i = 0; i < flags.size(); ++i) {
    if (can::extract_raw(frame, flags[i]) != 0) bits |= 1u << (static_cast<size_t>(first_bit) + i);
  }
  return bits;
}

double value_or_unknown(const can::Frame& frame, const can::Signal& signal) {
  return can::decode(frame, signal).value_or(can::ProtectionLevel::kUnknown);
}

}  // namespace

PoseReader::PoseReader(const can::BaseIds& base, can::GeodeticPosition map_origin)
    : base_(base),
      geo_(map_origin),
      checkers_{checker_of(*kInputs[kStatus]),    checker_of(*kInputs[kLatitude]),
                checker_of(*kInputs[kLongitude]), checker_of(*kInputs[kPosLocal]),
                checker_of(*kInputs[kAttitude]),  checker_of(*kInputs[kIntegrity])},
      joined_checker_(checker_of(can::loc_solution::kMessage)) {}

std::optional<BusPose> PoseReader::accept(const can::ReceivedFrame& received) {
  if (received.frame.id == can::loc_solution::kMessage.id(base_)) return accept_joined(received);
  for (size_t input = 0; input < kInputs.size(); ++input) {
    if (received.frame.id != kInputs[input]->id(base_)) continue;
    if (!can::is_usable(checkers_[input].check(received.frame))) return std::nullopt;
    take(static_cast<Input>(input), received);
    return input == kIntegrity ? assemble() : std::nullopt;
  }
  return std::nullopt;
}

std::optional<BusPose> PoseReader::accept_joined(const can::ReceivedFrame& received) {
  if (!can::is_usable(joined_checker_.check(received.frame))) return std::nullopt;
  for (size_t part = 0; part < can::loc_solution::kParts.size(); ++part) {
    const auto input = std::ranges::find(kInputs, can::loc_solution::kParts[part]);
    if (input == kInputs.end()) continue;
    take(static_cast<Input>(input - kInputs.begin()),
         {can::part_of_solution(received.frame, part, base_), received.received});
  }
  return assemble();
}

void PoseReader::take(Input input, const can::ReceivedFrame& received) {
  latest_[input] = received;
  if (input != kStatus) return;
  state_ = static_cast<HealthState>(can::extract_raw(received.frame, can::loc_status::kState));
}

std::optional<BusPose> PoseReader::assemble() {
  const int64_t epoch = epoch_of(latest_[kIntegrity].frame);
  for (const Input input : {kLatitude, kLongitude, kPosLocal, kAttitude}) {
    const can::Frame& frame = latest_[input].frame;
    if (frame.length == 0 || epoch_of(frame) != epoch) return std::nullopt;
  }
  const auto latitude = can::decode(latest_[kLatitude].frame, can::loc_latitude::kLatitude);
  const auto longitude = can::decode(latest_[kLongitude].frame, can::loc_longitude::kLongitude);
  const auto east = can::decode(latest_[kPosLocal].frame, can::loc_pos_local::kEast);
  const auto north = can::decode(latest_[kPosLocal].frame, can::loc_pos_local::kNorth);
  const auto heading = can::decode(latest_[kAttitude].frame, can::loc_attitude::kHeading);
  if (!latitude || !longitude || !east || !north || !heading) return std::nullopt;
  const Se2 geodetic = geo_.map_from_geodetic({{*latitude, *longitude}, *heading});
  return BusPose{
      latest_[kAttitude].received, {*east, *north, geodetic.yaw_rad}, protection_level()};
}

can::ProtectionLevel PoseReader::protection_level() const {
  namespace message = can::loc_integrity;
  const can::Frame& frame = latest_[kIntegrity].frame;
  const auto exponent = can::decode(frame, message::kRiskExponent);
  return {.longitudinal_m = value_or_unknown(frame, message::kLongitudinal),
          .lateral_m = value_or_unknown(frame, message::kLateral),
          .yaw_rad = radians(value_or_unknown(frame, message::kYaw)),
          .integrity_risk = exponent ? std::pow(10.0, -*exponent) : can::ProtectionLevel::kUnknown};
}

WhyMask PoseReader::why() const {
  const can::Frame& status = latest_[kStatus].frame;
  const can::Frame& integrity = latest_[kIntegrity].frame;
  uint32_t bits = 0;
  if (status.length != 0) bits |= why_bits(status, can::loc_status::kWhy, 0);
  if (integrity.length != 0) {
    bits |= why_bits(integrity, can::loc_integrity::kWhy, can::loc_integrity::kFirstWhy);
  }
  return WhyMask::from_bits(bits);
}

}  // namespace bevloc::evaluation
