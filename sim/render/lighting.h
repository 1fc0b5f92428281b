// Light and weather as the pixel loops need them.
#pragma once

#include <Eigen/Core>

#include "sim/render/renderer.h"
#include "sim/world/world.h"

namespace bevloc::sim {

inline Rgb operator*(float scale, const Rgb& c) {
  return {scale * c.r, scale * c.g, scale * c.b};
}
inline Rgb operator+(const Rgb& a, const Rgb& b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
inline Rgb operator*(const Rgb& a, const Rgb& b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
inline Rgb mix(const Rgb& a, const Rgb& b, float share_of_b) {
  return (1.0F - share_of_b) * a + share_of_b * b;
}

/// All colours are linear radiance after exposure: 1 is the brightest value that a pixel holds.
struct Lighting {
  Eigen::Vector3f to_sun = Eigen::Vector3f::UnitZ();  ///< map axes
  Rgb sun;      ///< direct light on a surface that faces the sun
  Rgb ambient;  ///< light of the sky on a surface that faces up
  Rgb sky_zenith;
  Rgb sky_horizon;
  Rgb haze;
  float haze_per_m = 0.0F;  ///< extinction
  float overcast = 0.0F;
  float wet = 0.0F;          ///< 0 dry to 1
  float headlights = 0.0F;   ///< the ego vehicle's own
  float lamps = 0.0F;        ///< street lamps
  float glow = 0.0F;         ///< lit windows, lamps of other vehicles
  float noise_sigma = 0.0F;  ///< in 8-bit steps

  bool casts_shadows() const { return sun.g > 0.02F; }
};

Lighting lighting_of(const Conditions& conditions);

}  // namespace bevloc::sim
