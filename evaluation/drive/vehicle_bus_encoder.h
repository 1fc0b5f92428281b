// Encodes odometry and GNSS for the bus of a simulated vehicle, with or without `can.vehicle`.
#pragma once

#include <span>
#include <variant>
#include <vector>

#include "can/messages/vehicle_encoder.h"
#include "common/result.h"
#include "evaluation/drive/dbc_vehicle_encoder.h"
#include "firmware/config/config.h"
#include "sim/faults/fault.h"

namespace bevloc::evaluation {

/// Encodes the messages of `can.vehicle`, or bevloc's own ones if the configuration does not have
/// it. A copy has counters of its own. The frames that a call returns are valid until the next
/// call. One thread.
class VehicleBusEncoder {
 public:
  /// `rear_track_m` is the distance between the rear wheels.
  VehicleBusEncoder(const firmware::CanConfig& can, can::GeodeticPosition map_origin,
                    double rear_track_m);

  std::span<const can::Frame> odometry(const can::WheelOdometry& measured);
  std::span<const can::Frame> odometry(const OdometrySample& sample);
  /// Returns no frames if `can.vehicle` has no GNSS.
  std::span<const can::Frame> gnss(const GnssSample& sample);

 private:
  std::span<const can::Frame> keep(std::span<const can::Frame> frames);

  std::variant<can::VehicleEncoder, DbcVehicleEncoder> encoder_;
  std::vector<can::Frame> frames_;
};

/// Fails for a fault that the messages of this bus cannot express.
Status check_expressible(const sim::Fault& fault, const firmware::CanConfig& can);

}  // namespace bevloc::evaluation
