// Converts light and weather into the values that the pixel loops use.
#pragma once

#include <Eigen/Core>

#include "sim/render/conditions.h"
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

/// All colours are linear radiance after exposure; 1 is full scale of a pixel.
struct Lighting {
  Eigen::Vector3f to_sun = Eigen::Vector3f::UnitZ();  ///< map axes
  Rgb sun;                                            ///< direct light on a surface facing the sun
  Rgb ambient;                                        ///< sky light on a surface facing up
  Rgb sky_zenith;
  Rgb sky_horizon;
  Rgb haze;
  float haze_per_m = 0.0F;  ///< extinction of the haze
  float overcast = 0.0F;
  float wet = 0.0F;          ///< 0 if dry, 1 if wet
  float headlights = 0.0F;   ///< headlights of the own vehicle
  float lamps = 0.0F;        ///< street lamps
  float glow = 0.0F;         ///< lit windows and lamps of other vehicles
  float noise_sigma = 0.0F;  ///< in 8-bit steps

  bool casts_shadows() const { return sun.g > 0.02F; }
};

Lighting lighting_of(const Conditions& conditions);

}  // namespace bevloc::sim
