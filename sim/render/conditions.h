// Light and weather of a drive.
#pragma once

#include <cstdint>

#include "sim/random.h"

namespace bevloc::sim {

/// Light, weather and camera quality, constant over one drive.
struct Conditions {
  double sun_azimuth_rad = 0.8;    ///< direction towards the sun, in map axes
  double sun_elevation_rad = 0.7;  ///< below 0 it is night, and the lamps are on
  double overcast = 0.3;           ///< 0 for hard shadows, 1 for no shadows
  double rain = 0.0;               ///< 0 if dry; at 1 the wet road mirrors the sky, at low contrast
  double exposure = 1.0;           ///< factor on the camera's gain
  double noise_sigma = 2.0;        ///< noise of one pixel, in 8-bit steps
};

/// Draws conditions with their usual frequencies: mostly day, some dusk, night and rain.
Conditions random_conditions(uint64_t seed);

/// Draws the elevation of the sun at night.
double random_night_elevation_rad(Random& random);

/// Adds rain of random strength and the clouds that come with it.
void add_rain(Random& random, Conditions& conditions);

}  // namespace bevloc::sim
