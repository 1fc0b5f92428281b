// What lies beyond the map: sky, clouds and a skyline.
#pragma once

#include <array>
#include <cstdint>

#include "sim/render/lighting.h"

namespace bevloc::sim {

class Sky {
 public:
  static constexpr int kSkylineSize = 2048;

  explicit Sky(uint64_t world_seed);

  /// Heights of the far skyline over the horizon (tangent of elevation), around the compass by
  /// skyline_place().
  const float* skyline() const { return skyline_.data(); }
  /// Grey of the skyline's houses and woods, 0 to 1.
  const float* skyline_shade() const { return shade_.data(); }

 private:
  std::array<float, kSkylineSize> skyline_{};
  std::array<float, kSkylineSize> shade_{};
};

/// Directions (map axes, z up, any length) and the sky's light from there. `sharpness_px` is the
/// focal length, which sets how soft the skyline's edge is.
struct SkyRun {
  const float* dx;
  const float* dy;
  const float* dz;
  float sharpness_px;
  float* red;
  float* green;
  float* blue;
};
void shade_sky(const Sky& sky, const Lighting& lighting, const SkyRun& run, int count);

}  // namespace bevloc::sim
