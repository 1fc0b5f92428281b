#include "evaluation/drive/pose_reader.h"

#include <algorithm>

#include "can/messages/solution_fd.h"

namespace bevloc::evaluation {
namespace {

can::E2eChecker checker_of(const can::Message& message) {
  return {message.protection(), message.length};
}

int64_t epoch_of(const can::Frame& frame) {
  return can::extract_raw(frame, can::kEpoch);
}

}  // namespace

PoseReader::PoseReader(const can::BaseIds& base, can::GeodeticPosition map_origin)
    : base_(base),
      geo_(map_origin),
      checkers_{checker_of(*kInputs[kStatus]), checker_of(*kInputs[kLatitude]),
                checker_of(*kInputs[kLongitude]), checker_of(*kInputs[kPosLocal]),
                checker_of(*kInputs[kAttitude])},
      joined_checker_(checker_of(can::loc_solution::kMessage)) {}

std::optional<BusPose> PoseReader::accept(const can::ReceivedFrame& received) {
  if (received.frame.id == can::loc_solution::kMessage.id(base_)) return accept_joined(received);
  for (size_t input = 0; input < kInputs.size(); ++input) {
    if (received.frame.id != kInputs[input]->id(base_)) continue;
    if (!can::is_usable(checkers_[input].check(received.frame))) return std::nullopt;
    take(static_cast<Input>(input), received.frame);
    return input == kAttitude ? assemble(received.received) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<BusPose> PoseReader::accept_joined(const can::ReceivedFrame& received) {
  if (!can::is_usable(joined_checker_.check(received.frame))) return std::nullopt;
  for (size_t part = 0; part < can::loc_solution::kParts.size(); ++part) {
    const auto input = std::ranges::find(kInputs, can::loc_solution::kParts[part]);
    if (input == kInputs.end()) continue;
    take(static_cast<Input>(input - kInputs.begin()),
         can::part_of_solution(received.frame, part, base_));
  }
  return assemble(received.received);
}

void PoseReader::take(Input input, const can::Frame& frame) {
  latest_[input] = frame;
  if (input != kStatus) return;
  state_ = static_cast<HealthState>(can::extract_raw(frame, can::loc_status::kState));
}

std::optional<BusPose> PoseReader::assemble(Time received) {
  const can::Frame& attitude = latest_[kAttitude];
  const int64_t epoch = epoch_of(attitude);
  for (const Input input : {kLatitude, kLongitude, kPosLocal}) {
    if (latest_[input].length == 0 || epoch_of(latest_[input]) != epoch) return std::nullopt;
  }
  const auto latitude = can::decode(latest_[kLatitude], can::loc_latitude::kLatitude);
  const auto longitude = can::decode(latest_[kLongitude], can::loc_longitude::kLongitude);
  const auto east = can::decode(latest_[kPosLocal], can::loc_pos_local::kEast);
  const auto north = can::decode(latest_[kPosLocal], can::loc_pos_local::kNorth);
  const auto heading = can::decode(attitude, can::loc_attitude::kHeading);
  if (!latitude || !longitude || !east || !north || !heading) return std::nullopt;
  const Se2 geodetic = geo_.map_from_geodetic({{*latitude, *longitude}, *heading});
  return BusPose{received, {*east, *north, geodetic.yaw_rad}};
}

}  // namespace bevloc::evaluation
