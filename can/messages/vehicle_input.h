// Decodes odometry and GNSS from the vehicle's CAN frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "can/e2e/e2e.h"
#include "can/messages/epoch_group.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message_table.h"
#include "common/vehicle_samples.h"

namespace bevloc::can {

struct VehicleInputCounters {
  uint64_t foreign = 0;  ///< frames that are not VEH_ messages
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t repeated = 0;
  uint64_t lost = 0;           ///< missing frames, detected by the counter
  uint64_t incomplete = 0;     ///< epochs with a missing message
  uint64_t not_available = 0;  ///< complete epochs with a signal that is SNA or out of range
  uint64_t odometry_samples = 0;
  uint64_t gnss_samples = 0;
};

/// Uses only frames with the right length, a right CRC and a new counter. Wheel speed and yaw rate
/// of one epoch make an odometry sample. Latitude, longitude and heading of one epoch make a GNSS
/// sample, which has no yaw when the heading is not available. Samples are always finite. The
/// caller has to detect time-outs from the time of the last sample.
///
/// Does not allocate. One thread.
class VehicleInput {
 public:
  VehicleInput(const BaseIds& base, GeodeticPosition map_origin);

  /// Returns a sample when this frame completes one.
  std::optional<VehicleSample> accept(const ReceivedFrame& received);

  VehicleInputCounters counters() const;
  std::optional<Time> last_odometry() const { return last_odometry_; }
  std::optional<Time> last_gnss() const { return last_gnss_; }

  /// Returns the identifiers that a filter of the bus has to let pass.
  static std::vector<uint32_t> accepted_ids(const BaseIds& base);

 private:
  static constexpr std::array<const Message*, 5> kInputs = {
      &veh_wheel_speed::kMessage, &veh_yaw_rate::kMessage, &veh_gnss_latitude::kMessage,
      &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage};
  static constexpr size_t kFirstGnss = 2;

  std::optional<VehicleSample> odometry_from(const EpochGroup<2>::Set& set);
  std::optional<VehicleSample> gnss_from(const EpochGroup<3>::Set& set);

  BaseIds base_;
  GeoReference geo_;
  std::array<E2eChecker, kInputs.size()> checkers_;
  EpochGroup<2> odometry_group_;
  EpochGroup<3> gnss_group_;
  VehicleInputCounters counters_;
  std::optional<Time> last_odometry_;
  std::optional<Time> last_gnss_;
};

}  // namespace bevloc::can
