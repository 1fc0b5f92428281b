#include "evaluation/drive/drive_street.h"

#include "sim/digest.h"
#include "sim/random.h"
#include "sim/samples/camera_looks.h"
#include "sim/samples/nuisances.h"
#include "sim/samples/training_nuisances.h"

namespace bevloc::evaluation {
namespace {

/// Looks that hide no part of the picture, because the rig file states what is hidden
/// (own_body_px).
sim::CameraLooks visible_looks(double factor) {
  sim::CameraLooks looks = sim::scaled(sim::street_looks(), factor);
  looks.body_share = 0.0;
  looks.black_rows_share = 0.0;
  return looks;
}

/// The curvatures of the street. The set draws its own evenly between plus and minus a limit; with
/// half of the limit as sigma, a normal distribution reaches about as far.
sim::GroundShape slopes_of(double factor) {
  const sim::Slopes largest = sim::nuisances_of(sim::NuisanceSet::kSlopes).slopes;
  const double half = 0.5 * factor;
  return {.along_per_m = half * largest.along_per_m,
          .across_per_m = half * largest.across_per_m,
          .twist_per_m = half * largest.twist_per_m};
}

}  // namespace

drivers::MockStreet street_of(const StreetConfig& config, uint64_t drive_seed) {
  const uint64_t seed = config.seed.value_or(drive_seed);
  drivers::MockStreet street;
  if (config.looks > 0.0) {
    street.looks = sim::random_looks(visible_looks(config.looks), seed);
    street.changes_pictures = true;
  }
  street.slopes = slopes_of(config.slopes);
  sim::Digest digest;
  digest.add(config.looks);
  digest.add(config.slopes);
  digest.add(config.looks > 0.0 ? seed : 0);
  digest.add(sim::seed_for(0, config.photos.string()));
  street.digest = digest.value();
  return street;
}

}  // namespace bevloc::evaluation
