// Applies faults to the readings of the simulated odometry.
#pragma once

#include <optional>
#include <span>

#include "sim/faults/fault.h"
#include "sim/sensors/odometry.h"

namespace bevloc::sim {

/// What the vehicle's odometry sends.
struct WheelReading {
  double left_mps = 0.0;  ///< speed of the left rear wheel
  double right_mps = 0.0;
  double yaw_rate_radps = 0.0;
  /// The motion that the front wheels show: the speed of the middle of the rear axle, and the true
  /// yaw rate. A fault that changes all wheel speeds by a factor changes both.
  double front_speed_mps = 0.0;
  double front_yaw_rate_radps = 0.0;
};

/// The reading `index` under the `active` faults, or nothing if none is sent. `rear_track_m` is the
/// distance between the rear wheels. A fault of the yaw rate leaves the wheels as they are, and
/// kOdometryWheels leaves the front wheels as they are. Faults of other inputs are ignored.
std::optional<WheelReading> reading_with_faults(const OdometrySimulator& odometry, size_t index,
                                                double rear_track_m, std::span<const Fault> active);

}  // namespace bevloc::sim
