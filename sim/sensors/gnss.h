// A satellite receiver with two antennas, as its errors look from outside.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/vehicle/drive.h"

namespace bevloc::sim {

struct GnssReading {
  double time_s = 0.0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< of the vehicle's origin, map frame
  double heading_rad = 0.0;
  double position_sigma_m = 0.0;  ///< per axis, as the receiver claims
  double heading_sigma_rad = 0.0;
};

/// Readings at 10 Hz. Errors are first-order Gauss-Markov (1.0 m per axis with 40 s, 1.0 degree
/// with 20 s) plus white noise (0.25 m, 0.3 degrees). Immutable after construction.
class GnssSimulator {
 public:
  static constexpr double kPeriod_s = 0.1;

  /// Keeps a reference to the drive.
  GnssSimulator(const Drive& drive, uint64_t seed);

  /// Reading `index` is taken at index * kPeriod_s; index < count().
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
