// Reads bevloc's poses off the bus, as any consumer would.
#pragma once

#include <array>
#include <optional>

#include "can/e2e.h"
#include "can/geo_reference.h"
#include "can/message_table.h"
#include "can/pose_report.h"

namespace bevloc::firmware {

/// One solution that was sent as valid.
struct BusPose {
  Time received;  ///< the pose is predicted to the moment of sending
  Se2 map_from_vehicle;
};

/// Reads both variants. Only frames that pass their E2E check count; the frames of a pose are of
/// one epoch. One thread.
class PoseReader {
 public:
  PoseReader(const can::BaseIds& base, can::GeodeticPosition map_origin);

  /// A pose when this frame completes one.
  std::optional<BusPose> accept(const can::ReceivedFrame& received);

  /// As of the latest LOC_Status.
  can::LocalizerState state() const { return state_; }

 private:
  enum Input : size_t { kStatus, kLatitude, kLongitude, kPosLocal, kAttitude };
  static constexpr std::array<const can::Message*, 5> kInputs = {
      &can::loc_status::kMessage, &can::loc_latitude::kMessage, &can::loc_longitude::kMessage,
      &can::loc_pos_local::kMessage, &can::loc_attitude::kMessage};

  std::optional<BusPose> accept_joined(const can::ReceivedFrame& received);
  void take(Input input, const can::Frame& frame);
  std::optional<BusPose> assemble(Time received);

  can::BaseIds base_;
  can::GeoReference geo_;
  std::array<can::E2eChecker, kInputs.size()> checkers_;
  can::E2eChecker joined_checker_;
  std::array<can::Frame, kInputs.size()> latest_{};
  can::LocalizerState state_ = can::LocalizerState::kInit;
};

}  // namespace bevloc::firmware
