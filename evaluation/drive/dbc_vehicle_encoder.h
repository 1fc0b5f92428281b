// Encodes odometry and GNSS as the messages of `can.vehicle`, for the simulated vehicle and for
// tests.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "can/messages/geo_reference.h"
#include "can/messages/vehicle_encoder.h"
#include "can/vehicle/vehicle_binding.h"
#include "common/vehicle_samples.h"

namespace bevloc::evaluation {

/// The inverse of can::DbcVehicleInput: sends only valid values. Each call makes one frame of each
/// message with a signal of odometry or of GNSS, and one more for each further value of its
/// multiplexor. One thread.
class DbcVehicleEncoder {
 public:
  DbcVehicleEncoder(const can::VehicleBinding& binding, can::GeodeticPosition map_origin,
                    double rear_track_m);

  /// The frames are valid until the next call.
  std::span<const can::Frame> odometry(const can::WheelOdometry& measured);
  std::span<const can::Frame> odometry(const OdometrySample& sample);
  /// The frames of a GNSS sample; none if the binding has no GNSS.
  std::span<const can::Frame> gnss(const GnssSample& sample);

 private:
  struct Value {
    size_t signal = 0;
    double physical = 0.0;  ///< in the unit of the DBC file
  };

  void set(size_t signal, double value);
  void set(const std::optional<can::BoundCondition>& condition, bool holds);
  std::span<const can::Frame> frames();
  void add_frames(size_t message);

  can::VehicleBinding binding_;
  can::GeoReference geo_;
  double rear_track_m_;
  std::vector<Value> values_;
  std::vector<uint8_t> counters_;  ///< of each message
  std::vector<can::Frame> frames_;
};

}  // namespace bevloc::evaluation
