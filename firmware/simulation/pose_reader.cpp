#include "firmware/simulation/pose_reader.h"

namespace bevloc::firmware {
namespace {

enum Input : size_t { kStatus, kLatitude, kLongitude, kPosLocal, kAttitude };

can::E2eChecker checker_of(const can::Message& message) {
  return {message.data_id, message.length};
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
                checker_of(*kInputs[kAttitude])} {}

std::optional<BusPose> PoseReader::accept(const can::ReceivedFrame& received) {
  for (size_t input = 0; input < kInputs.size(); ++input) {
    if (received.frame.id != kInputs[input]->id(base_)) continue;
    if (!can::is_usable(checkers_[input].check(received.frame))) return std::nullopt;
    latest_[input] = received.frame;
    if (input == kStatus) {
      state_ = static_cast<can::LocalizerState>(
          can::extract_raw(received.frame, can::loc_status::kState));
    }
    return input == kAttitude ? assemble(received) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<BusPose> PoseReader::assemble(const can::ReceivedFrame& attitude) {
  const int64_t epoch = epoch_of(attitude.frame);
  for (const Input input : {kLatitude, kLongitude, kPosLocal}) {
    if (latest_[input].length == 0 || epoch_of(latest_[input]) != epoch) return std::nullopt;
  }
  const auto latitude = can::decode(latest_[kLatitude], can::loc_latitude::kLatitude);
  const auto longitude = can::decode(latest_[kLongitude], can::loc_longitude::kLongitude);
  const auto east = can::decode(latest_[kPosLocal], can::loc_pos_local::kEast);
  const auto north = can::decode(latest_[kPosLocal], can::loc_pos_local::kNorth);
  const auto heading = can::decode(attitude.frame, can::loc_attitude::kHeading);
  if (!latitude || !longitude || !east || !north || !heading) return std::nullopt;
  const Se2 geodetic = geo_.map_from_geodetic({{*latitude, *longitude}, *heading});
  return BusPose{attitude.received, {*east, *north, geodetic.yaw_rad}};
}

}  // namespace bevloc::firmware
