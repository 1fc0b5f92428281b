// Reads odometry and GNSS from the vehicle's frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "can/e2e.h"
#include "can/epoch_group.h"
#include "can/geo_reference.h"
#include "can/message_table.h"
#include "can/vehicle_samples.h"

namespace bevloc::can {

/// std::monostate: the frame completed no sample.
using VehicleSample = std::variant<std::monostate, OdometrySample, GnssSample>;

struct VehicleInputCounters {
  uint64_t foreign = 0;  ///< frames that are none of the VEH_ messages
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t repeated = 0;
  uint64_t lost = 0;           ///< frames missing by their counter
  uint64_t incomplete = 0;     ///< epochs of which a message never came
  uint64_t not_available = 0;  ///< complete epochs with a signal that says SNA or is out of range
  uint64_t odometry_samples = 0;
  uint64_t gnss_samples = 0;
};

/// Only frames with the right length, CRC and a new counter are used. Wheel speed and yaw rate of
/// one epoch make an odometry sample; latitude, longitude and heading of one epoch make a GNSS
/// sample, without a yaw when the heading is not available. Samples are always finite. A time-out
/// is the caller's to notice, by the time of the last sample.
///
/// Does not allocate. One thread at a time.
class VehicleInput {
 public:
  VehicleInput(const BaseIds& base, GeodeticPosition map_origin);

  VehicleSample accept(const ReceivedFrame& received);

  VehicleInputCounters counters() const;
  std::optional<Time> last_odometry() const { return last_odometry_; }
  std::optional<Time> last_gnss() const { return last_gnss_; }

  /// The identifiers to let through where the bus can filter.
  static std::vector<uint32_t> accepted_ids(const BaseIds& base);

 private:
  static constexpr std::array<const Message*, 5> kInputs = {
      &veh_wheel_speed::kMessage, &veh_yaw_rate::kMessage, &veh_gnss_latitude::kMessage,
      &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage};
  static constexpr size_t kFirstGnss = 2;

  VehicleSample odometry_from(const EpochGroup<2>::Set& set);
  VehicleSample gnss_from(const EpochGroup<3>::Set& set);

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
