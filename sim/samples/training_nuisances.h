// Training shows more trouble than is usual: in a share of its samples a nuisance is stronger.
#pragma once

#include <cstdint>

#include "sim/samples/nuisances.h"

namespace bevloc::sim {

/// In a share of the cases a strength, drawn evenly between two; in the others the usual one.
struct Strengthening {
  double share = 0.0;
  double weakest = 0.0;
  double strongest = 0.0;
};

/// All shares are zero: nothing is changed, not by a bit.
struct TrainingNuisances {
  // Drawn for each sample.
  Strengthening camera_spread_s;     ///< cameras out of step by so much, compensated
  Strengthening calibration_factor;  ///< on the deviations of CalibrationSigma
  Strengthening body_tilt_rad;       ///< of BodySigma

  // Drawn for each world, because they change it.
  Strengthening extra_vehicles;     ///< around each pose; rounded
  Strengthening paint_wear_factor;  ///< of Nuisances
  Strengthening map_errors;         ///< times those of the set `map_errors`
};

/// What training shows unless it is told otherwise.
TrainingNuisances strong_nuisances();

/// `usual` with what is drawn for a world, and that with what is drawn for one of its samples. What
/// is drawn for one nuisance follows from the seed and its own entry alone.
Nuisances drawn_for_world(const Nuisances& usual, const TrainingNuisances& training, uint64_t seed);
Nuisances drawn_for_sample(const Nuisances& of_world, const TrainingNuisances& training,
                           uint64_t seed);

}  // namespace bevloc::sim
