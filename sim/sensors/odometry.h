// Simulates the vehicle's own odometry: speed and yaw rate as its bus reports them.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/vehicle/drive.h"

namespace bevloc::sim {

struct OdometryReading {
  double time_s = 0.0;
  double speed_mps = 0.0;  ///< mean of the rear wheels
  double yaw_rate_radps = 0.0;
  double path_yaw_rate_radps = 0.0;  ///< the true yaw rate, which the wheels follow
  /// How much faster the right wheel turns than the path demands.
  double wheel_excess_mps = 0.0;
};

/// Readings at 50 Hz. Speed: a scale error per drive (sigma 1 %) and white noise (sigma 0.03 m/s).
/// Yaw rate: a bias per drive (sigma 0.1 degrees/s) with a slow random walk, and white noise (sigma
/// 0.1 degrees/s). The rear wheels differ in radius (sigma 0.3 %) and have white noise. Immutable,
/// and so thread-safe.
class OdometrySimulator {
 public:
  static constexpr double kPeriod_s = 0.02;

  /// The drive must outlive the simulator.
  OdometrySimulator(const Drive& drive, uint64_t seed);

  /// The reading at time index * kPeriod_s; index < count().
  OdometryReading reading(size_t index) const;
  size_t count() const { return errors_.size(); }

  /// The factor between reported and true speed, for tests.
  double speed_scale() const { return speed_scale_; }

 private:
  struct Error {
    double speed_mps;
    double yaw_rate_radps;
    double wheels_mps;  ///< right minus left wheel
  };

  const Drive& drive_;
  double speed_scale_;
  double radius_difference_;  ///< radius of right against left wheel, as a share of the speed
  std::vector<Error> errors_;
};

}  // namespace bevloc::sim
