// Renders what lies beyond the map: sky, clouds and a skyline.
#pragma once

#include <array>
#include <cstdint>

#include "sim/render/lighting.h"

namespace bevloc::sim {

/// The skyline of one world. Immutable, and so thread-safe.
class Sky {
 public:
  static constexpr int kSkylineSize = 2048;

  explicit Sky(uint64_t world_seed);

  /// kSkylineSize heights of the skyline over the horizon (tangent of the elevation), all around.
  const float* skyline() const { return skyline_.data(); }
  /// kSkylineSize grey values of the skyline's houses and woods, 0 to 1.
  const float* skyline_shade() const { return shade_.data(); }

 private:
  std::array<float, kSkylineSize> skyline_{};
  std::array<float, kSkylineSize> shade_{};
};

/// The inputs and outputs of shade_sky().
struct SkyRun {
  const float* dx;  ///< directions in map axes, z up, of any length
  const float* dy;
  const float* dz;
  float sharpness_px;  ///< focal length, for the anti-aliasing of the skyline
  float* red;          ///< radiance of the sky in these directions
  float* green;
  float* blue;
};
/// Computes the radiance of the sky for `count` directions.
void shade_sky(const Sky& sky, const Lighting& lighting, const SkyRun& run, int count);

}  // namespace bevloc::sim
