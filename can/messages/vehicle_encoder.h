// Encodes odometry and GNSS as CAN frames, for the simulated vehicle and for tests.
#pragma once

#include <array>
#include <cstdint>

#include "can/e2e/e2e.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message_table.h"
#include "common/vehicle_samples.h"

namespace bevloc::can {

/// Odometry as the sensors measure it.
struct WheelOdometry {
  double left_mps = 0.0;  ///< speeds of the rear wheels
  double right_mps = 0.0;
  double yaw_rate_radps = 0.0;
  /// The motion that the front wheels measure, if the vehicle sends their speeds: the speed of the
  /// middle of the rear axle, and the yaw rate.
  double front_speed_mps = 0.0;
  double front_yaw_rate_radps = 0.0;
};

/// Makes the protected frames that VehicleInput reads, from the same message table. They have no
/// front wheels. A value that is not finite is sent as SNA. One thread.
class VehicleEncoder {
 public:
  /// `rear_track_m` is the distance between the rear wheels, whose speeds differ in a bend.
  VehicleEncoder(const BaseIds& base, GeodeticPosition map_origin, double rear_track_m);

  std::array<Frame, 2> odometry(const OdometrySample& sample);
  std::array<Frame, 2> odometry(const WheelOdometry& measured);
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
