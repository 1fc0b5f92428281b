#include "sim/render/conditions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/se2.h"

namespace bevloc::sim {

double random_night_elevation_rad(Random& random) {
  return radians(random.uniform(-40.0, -12.0));
}

void add_rain(Random& random, Conditions& conditions) {
  conditions.rain = random.uniform(0.2, 1.0);
  conditions.overcast = std::max(conditions.overcast, random.uniform(0.75, 1.0));
}

Conditions random_conditions(uint64_t seed) {
  Random random(seed_for(seed, "conditions"));
  Conditions conditions;
  conditions.sun_azimuth_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
  const double time_of_day = random.uniform();
  if (time_of_day < 0.10) {
    conditions.sun_elevation_rad = random_night_elevation_rad(random);
  } else if (time_of_day < 0.22) {
    conditions.sun_elevation_rad = radians(random.uniform(-5.0, 9.0));
  } else {
    conditions.sun_elevation_rad = radians(random.uniform(12.0, 68.0));
  }
  // Half of the days have a clear or broken sky, the others are grey.
  conditions.overcast = random.chance(0.5) ? random.uniform(0.0, 0.4) : random.uniform(0.5, 1.0);
  if (random.chance(0.15)) add_rain(random, conditions);
  conditions.exposure = std::exp(random.normal(0.0, 0.18));
  conditions.noise_sigma = random.uniform(1.0, 3.5);
  return conditions;
}

}  // namespace bevloc::sim
