// Simulates a GNSS receiver with two antennas: position and heading with realistic errors.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/vehicle/drive.h"

namespace bevloc::sim {

struct GnssReading {
  double time_s = 0.0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< the vehicle's origin in the map frame
  double heading_rad = 0.0;
  double position_sigma_m = 0.0;  ///< per axis, as reported by the receiver
  double heading_sigma_rad = 0.0;
  bool has_heading = true;
};

/// Readings at 10 Hz. The errors are a first-order Gauss-Markov process (sigma 1.0 m per axis, time
/// constant 40 s; sigma 1.0 degree, time constant 20 s) plus white noise (0.25 m, 0.3 degrees).
/// Immutable, and so thread-safe.
class GnssSimulator {
 public:
  static constexpr double kPeriod_s = 0.1;

  /// The drive must outlive the simulator.
  GnssSimulator(const Drive& drive, uint64_t seed);

  /// The reading at time index * kPeriod_s; index < count().
  GnssReading reading(size_t index) const;
  size_t count() const { return errors_.size(); }

 private:
  struct Error {
    Eigen::Vector2d position_m;
    double heading_rad;
  };

  const Drive& drive_;
  std::vector<Error> errors_;
};

}  // namespace bevloc::sim
