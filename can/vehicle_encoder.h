// The vehicle's side of the bus: puts its sensors into frames, as the simulated vehicle does.
#pragma once

#include <array>
#include <cstdint>

#include "can/e2e.h"
#include "can/geo_reference.h"
#include "can/message_table.h"
#include "can/vehicle_samples.h"

namespace bevloc::can {

/// Makes the frames that VehicleInput reads, from the same table. What is not finite is sent as
/// SNA. One thread at a time.
class VehicleEncoder {
 public:
  /// `rear_track_m` is the distance between the rear wheels: in a bend they turn at two speeds.
  VehicleEncoder(const BaseIds& base, GeodeticPosition map_origin, double rear_track_m);

  std::array<Frame, 2> odometry(const OdometrySample& sample);
  std::array<Frame, 3> gnss(const GnssSample& sample);

 private:
  BaseIds base_;
  GeoReference geo_;
  double rear_track_m_;
  uint8_t odometry_epoch_ = 0;
  uint8_t gnss_epoch_ = 0;
  std::array<E2eSender, 2> odometry_senders_;
  std::array<E2eSender, 3> gnss_senders_;
};

}  // namespace bevloc::can
