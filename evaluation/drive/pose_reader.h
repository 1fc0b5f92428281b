// Decodes bevloc's poses from CAN frames, as a consumer does.
#pragma once

#include <array>
#include <optional>

#include "can/e2e/e2e.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message_table.h"
#include "can/messages/pose_report.h"

namespace bevloc::evaluation {

/// A solution that was sent as valid.
struct BusPose {
  Time received;  ///< the pose is predicted to the time of sending
  Se2 map_from_vehicle;
  can::ProtectionLevel protection_level;  ///< a value that was sent as SNA is unknown
};

/// Decodes both variants: separate frames, and one CAN FD frame. Frames that fail the E2E check are
/// ignored, and the frames of a pose must have the same epoch. One thread.
class PoseReader {
 public:
  PoseReader(const can::BaseIds& base, can::GeodeticPosition map_origin);

  /// Returns a pose if this frame completes one.
  std::optional<BusPose> accept(const can::ReceivedFrame& received);

  /// The state in the latest LOC_Status.
  HealthState state() const { return state_; }

  /// The reasons in the latest LOC_Status and LOC_Integrity.
  WhyMask why() const;

 private:
  enum Input : size_t { kStatus, kLatitude, kLongitude, kPosLocal, kAttitude, kIntegrity };
  static constexpr std::array<const can::Message*, 6> kInputs = {
      &can::loc_status::kMessage,    &can::loc_latitude::kMessage, &can::loc_longitude::kMessage,
      &can::loc_pos_local::kMessage, &can::loc_attitude::kMessage, &can::loc_integrity::kMessage};

  std::optional<BusPose> accept_joined(const can::ReceivedFrame& received);
  void take(Input input, const can::ReceivedFrame& received);
  std::optional<BusPose> assemble();
  can::ProtectionLevel protection_level() const;

  can::BaseIds base_;
  can::GeoReference geo_;
  std::array<can::E2eChecker, kInputs.size()> checkers_;
  can::E2eChecker joined_checker_;
  std::array<can::ReceivedFrame, kInputs.size()> latest_{};
  HealthState state_ = HealthState::kInit;
};

}  // namespace bevloc::evaluation
