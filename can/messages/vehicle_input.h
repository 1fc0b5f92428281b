// Decodes odometry and GNSS from the vehicle's CAN frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "can/e2e/e2e_receiver.h"
#include "can/messages/epoch_group.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message_table.h"
#include "can/messages/odometry_check.h"
#include "common/health_state.h"
#include "common/vehicle_samples.h"

namespace bevloc::can {

struct VehicleInputCounters {
  uint64_t foreign = 0;  ///< frames that are neither VEH_ nor LOC_ messages
  uint64_t own_ids = 0;  ///< frames of another node with an identifier of a LOC_ message
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t repeated = 0;
  uint64_t wrong_sequence = 0;        ///< the counter does not continue the sequence
  uint64_t not_valid = 0;             ///< good frames of a message that is not VALID (E2eReceiver)
  uint64_t lost = 0;                  ///< missing frames, detected by the counter
  uint64_t incomplete = 0;            ///< epochs with a missing message
  uint64_t not_available = 0;         ///< complete epochs with a signal that is SNA or out of range
  uint64_t contradicting_wheels = 0;  ///< odometry refused: the wheels contradict the yaw rate
  uint64_t odometry_jumps = 0;        ///< odometry refused: faster changes than a vehicle can make
  uint64_t sharp_turns = 0;           ///< odometry refused: sharper turns than a vehicle can make
  uint64_t odometry_samples = 0;
  uint64_t gnss_samples = 0;
};

/// Uses only the frames that E2eReceiver accepts. Wheel speed and yaw rate
/// of one epoch make an odometry sample. Latitude, longitude and heading of one epoch make a GNSS
/// sample, which has no yaw when the heading is not available. Samples are always finite, and
/// odometry is plausible (OdometryCheck). The caller has to detect time-outs from the time of the
/// last sample.
///
/// Does not allocate. One thread.
class VehicleInput {
 public:
  VehicleInput(const BaseIds& base, GeodeticPosition map_origin, const OdometryLimits& limits = {});

  /// Returns a sample when this frame completes one.
  std::optional<VehicleSample> accept(const ReceivedFrame& received);

  VehicleInputCounters counters() const;

  /// kOdometryImplausible while odometry is refused, INVALID or too slow, kForeignSender while
  /// another node sends LOC_ messages or two nodes send the same VEH_ message. Each is kept for
  /// `kWhyHold` after its cause.
  WhyMask why() const;
  static constexpr Duration kWhyHold = std::chrono::seconds(1);

  std::optional<Time> last_odometry() const { return last_odometry_; }
  std::optional<Time> last_gnss() const { return last_gnss_; }

  /// Returns the identifiers that a filter of the bus has to let pass, with or without
  /// authentication.
  static std::vector<uint32_t> accepted_ids(const BaseIds& base, bool secoc = false);

 private:
  static constexpr std::array<const Message*, 5> kInputs = {
      &veh_wheel_speed::kMessage, &veh_yaw_rate::kMessage, &veh_gnss_latitude::kMessage,
      &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage};
  static constexpr size_t kFirstGnss = 2;

  std::optional<VehicleSample> odometry_from(const EpochGroup<2>::Set& set);
  std::optional<VehicleSample> gnss_from(const EpochGroup<3>::Set& set);

  BaseIds base_;
  GeoReference geo_;
  std::array<E2eReceiver, kInputs.size()> receivers_;
  EpochGroup<2> odometry_group_;
  EpochGroup<3> gnss_group_;
  OdometryCheck odometry_check_;
  VehicleInputCounters counters_;
  Time latest_{};                       ///< when the latest frame arrived
  std::optional<Time> implausible_;     ///< the latest refused odometry
  std::optional<Time> foreign_sender_;  ///< the latest sign of another sender
  std::optional<Time> last_odometry_;
  std::optional<Time> last_gnss_;
};

}  // namespace bevloc::can
