// A vehicle on its way past the place of a sample, and when its cameras expose.
#pragma once

#include <cstdint>

#include "common/se2.h"
#include "sim/random.h"
#include "sim/samples/nuisances.h"

namespace bevloc::sim {

/// Steady speed and yaw rate, drawn from the seed. Not thread safe.
class Passage {
 public:
  Passage(const Desynchronisation& desynchronisation, uint64_t seed);

  /// When the next camera exposes, counted from the time of the sample's pose.
  double next_offset_s();

  /// Where the vehicle truly is then, seen from where it is at the time of the pose.
  Se2 true_motion(double offset_s) const;

  /// The same as the vehicle knows it from its odometry, or zero where nothing compensates.
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
