// Wheel speed and yaw rate, as a vehicle's bus reports them.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/vehicle/drive.h"

namespace bevloc::sim {

struct OdometryReading {
  double time_s = 0.0;
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// Readings at 50 Hz. Speed: scale error of 1 % per drive and white noise of 0.03 m/s. Yaw rate:
/// bias of 0.1 degrees/s per drive that slowly walks, and white noise of 0.1 degrees/s. Immutable
/// after construction.
class OdometrySimulator {
 public:
  static constexpr double kPeriod_s = 0.02;

  /// Keeps a reference to the drive.
  OdometrySimulator(const Drive& drive, uint64_t seed);

  /// Reading `index` is taken at index * kPeriod_s; index < count().
  OdometryReading reading(size_t index) const;
  size_t count() const { return errors_.size(); }

  double speed_scale() const { return speed_scale_; }

 private:
  struct Error {
    double speed_mps;
    double yaw_rate_radps;
  };

  const Drive& drive_;
  double speed_scale_;
  std::vector<Error> errors_;
};

}  // namespace bevloc::sim
