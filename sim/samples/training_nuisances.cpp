#include "sim/samples/training_nuisances.h"

#include <cmath>
#include <optional>
#include <string_view>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

std::optional<double> drawn(const Strengthening& strengthening, uint64_t seed,
                            std::string_view purpose) {
  Random random(seed_for(seed_for(seed, "stronger"), purpose));
  if (!random.chance(strengthening.share)) return std::nullopt;
  return random.uniform(strengthening.weakest, strengthening.strongest);
}

}  // namespace

TrainingNuisances strong_nuisances() {
  TrainingNuisances nuisances;
  nuisances.camera_spread_s = {.share = 0.25, .weakest = 0.05, .strongest = 0.05};
  nuisances.calibration_factor = {.share = 1.0, .weakest = 1.0, .strongest = 1.7};
  nuisances.body_tilt_rad = {.share = 1.0, .weakest = radians(0.2), .strongest = radians(1.0)};
  nuisances.extra_vehicles = {.share = 0.2, .weakest = 1.0, .strongest = 8.0};
  nuisances.paint_wear_factor = {.share = 0.2, .weakest = 1.0, .strongest = 2.0};
  nuisances.map_errors = {.share = 0.15, .weakest = 1.0, .strongest = 1.0};
  return nuisances;
}

TrainingNuisances street_nuisances() {
  TrainingNuisances nuisances = strong_nuisances();
  nuisances.rig_variety = {.share = 0.4, .weakest = 0.05, .strongest = 1.0};
  nuisances.looks = {.share = 0.8, .weakest = 0.2, .strongest = 1.3};
  nuisances.noise_factor = {.share = 0.7, .weakest = 0.2, .strongest = 1.0};
  nuisances.slopes = {.share = 0.5, .weakest = 0.2, .strongest = 1.2};
  nuisances.map_habits = {.share = 0.5, .weakest = 0.2, .strongest = 1.6};
  nuisances.clutter = {.share = 0.7, .weakest = 0.2, .strongest = 1.5};
  nuisances.verge_share = {.share = 0.3, .weakest = 0.1, .strongest = 0.7};
  return nuisances;
}

CameraLooks street_looks() {
  return {.cast = 0.25,
          .least_saturation = 0.0,
          .most_saturation = 1.5,
          .grey_share = 0.2,
          .contrast = 0.6,
          .sharpness = 0.8,
          .smear_share = 0.1,
          .body_share = 0.5,
          .black_rows_share = 0.2};
}

Nuisances drawn_for_world(const Nuisances& usual, const TrainingNuisances& training,
                          uint64_t seed) {
  Nuisances nuisances = usual;
  if (const auto count = drawn(training.extra_vehicles, seed, "vehicles")) {
    nuisances.extra_vehicles = static_cast<int>(std::lround(*count));
  }
  if (const auto factor = drawn(training.paint_wear_factor, seed, "wear")) {
    nuisances.paint_wear_factor = *factor;
  }
  if (const auto factor = drawn(training.map_errors, seed, "map")) {
    const MapErrors errors = nuisances_of(NuisanceSet::kMapErrors).map_errors;
    nuisances.map_errors = {.omission = *factor * errors.omission,
                            .ghost = *factor * errors.ghost,
                            .shift_sigma_m = *factor * errors.shift_sigma_m};
  }
  if (const auto factor = drawn(training.map_habits, seed, "habits")) {
    nuisances.map_habits = scaled(nuisances_of(NuisanceSet::kMapHabits).map_habits, *factor);
  }
  if (const auto factor = drawn(training.clutter, seed, "clutter")) {
    nuisances.clutter = scaled(nuisances_of(NuisanceSet::kClutter).clutter, *factor);
  }
  if (const auto share = drawn(training.verge_share, seed, "verges")) {
    nuisances.verge_share = *share;
  }
  return nuisances;
}

Nuisances drawn_for_sample(const Nuisances& of_world, const TrainingNuisances& training,
                           uint64_t seed) {
  Nuisances nuisances = of_world;
  if (const auto variety = drawn(training.rig_variety, seed, "rig")) {
    nuisances.rig_variety = *variety;
  }
  if (const auto spread_s = drawn(training.camera_spread_s, seed, "spread")) {
    nuisances.desynchronisation.spread_s = *spread_s;
  }
  if (const auto factor = drawn(training.calibration_factor, seed, "calibration")) {
    nuisances.calibration.rotation_rad *= *factor;
    nuisances.calibration.position_m *= *factor;
    nuisances.calibration.relative_focal *= *factor;
  }
  if (const auto tilt_rad = drawn(training.body_tilt_rad, seed, "tilt")) {
    nuisances.body.tilt_rad = *tilt_rad;
  }
  if (const auto factor = drawn(training.looks, seed, "looks")) {
    nuisances.looks = scaled(street_looks(), *factor);
  }
  if (const auto factor = drawn(training.noise_factor, seed, "noise")) {
    nuisances.noise_factor = *factor;
  }
  if (const auto factor = drawn(training.slopes, seed, "slopes")) {
    const Slopes slopes = nuisances_of(NuisanceSet::kSlopes).slopes;
    nuisances.slopes = {.along_per_m = *factor * slopes.along_per_m,
                        .across_per_m = *factor * slopes.across_per_m,
                        .twist_per_m = *factor * slopes.twist_per_m};
  }
  return nuisances;
}

}  // namespace bevloc::sim
