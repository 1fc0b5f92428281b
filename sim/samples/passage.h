// Simulates the vehicle's motion between the exposures of a sample's cameras.
#pragma once

#include <cstdint>

#include "common/se2.h"
#include "sim/random.h"
#include "sim/samples/nuisances.h"

namespace bevloc::sim {

/// The vehicle passes the pose of a sample with constant speed and yaw rate, drawn from the seed.
/// One thread.
class Passage {
 public:
  Passage(const Desynchronisation& desynchronisation, uint64_t seed);

  /// Draws the exposure time of the next camera, relative to the time of the sample's pose.
  double next_offset_s();

  /// The vehicle's true pose at that time, in the vehicle frame of the sample's pose.
  Se2 true_motion(double offset_s) const;

  /// The same motion from the vehicle's odometry, or the identity if the motion is not compensated.
  Se2 known_motion(double offset_s) const;

 private:
  struct Rates {
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };

  Desynchronisation desynchronisation_;
  Random random_;
  Rates true_rates_;
  Rates known_rates_;
};

}  // namespace bevloc::sim
