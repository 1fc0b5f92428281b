// Stronger nuisances for training: in a share of the samples a nuisance exceeds its usual strength.
#pragma once

#include <cstdint>

#include "sim/samples/nuisances.h"

namespace bevloc::sim {

/// In a share of the cases the strength is uniform between two values; otherwise it stays as usual.
struct Strengthening {
  double share = 0.0;
  double weakest = 0.0;
  double strongest = 0.0;
};

/// By default all shares are zero, so that no bit of a sample changes.
struct TrainingNuisances {
  // These are drawn for each sample.
  Strengthening rig_variety;         ///< Nuisances::rig_variety
  Strengthening camera_spread_s;     ///< Desynchronisation::spread_s, with compensation
  Strengthening calibration_factor;  ///< multiplies all of CalibrationSigma
  Strengthening body_tilt_rad;       ///< BodySigma::tilt_rad
  Strengthening looks;               ///< factor on street_looks()
  Strengthening noise_factor;        ///< Nuisances::noise_factor
  Strengthening slopes;              ///< factor on the slopes of NuisanceSet::kSlopes

  // These are drawn for each world, because they change the world.
  Strengthening extra_vehicles;     ///< Nuisances::extra_vehicles, rounded
  Strengthening paint_wear_factor;  ///< Nuisances::paint_wear_factor
  Strengthening map_errors;         ///< factor on the errors of NuisanceSet::kMapErrors
  Strengthening map_habits;         ///< factor on the habits of NuisanceSet::kMapHabits
  Strengthening clutter;            ///< factor on the clutter of NuisanceSet::kClutter
  Strengthening verge_share;        ///< Nuisances::verge_share
};

/// Weather, wear, calibration and map errors beyond the usual.
TrainingNuisances strong_nuisances();

/// The default of training: strong_nuisances(), and what real streets, cameras and maps have beyond
/// the simulator's own.
TrainingNuisances street_nuisances();

/// How far the cameras of real vehicles differ from the simulator's.
CameraLooks street_looks();

/// Replaces the nuisances that are drawn for each world, or for each sample of a world. The value
/// of one nuisance depends on the seed and its own entry alone.
Nuisances drawn_for_world(const Nuisances& usual, const TrainingNuisances& training, uint64_t seed);
Nuisances drawn_for_sample(const Nuisances& of_world, const TrainingNuisances& training,
                           uint64_t seed);

}  // namespace bevloc::sim
