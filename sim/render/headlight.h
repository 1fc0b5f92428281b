// The light of the own vehicle's dipped headlights, and the colours of lamps.
#pragma once

#include <algorithm>

#include "sim/world/world.h"

namespace bevloc::sim {

inline constexpr Rgb kHeadlightColour{1.0F, 0.96F, 0.88F};
inline constexpr Rgb kLampColour{1.0F, 0.76F, 0.48F};

/// Relative light at a place `ahead_m` in front of the rear axle and `aside_m` beside the centre
/// line.
inline float headlight_share(float ahead_m, float aside_m) {
  const float from_lamp = ahead_m - 3.2F;
  const float reach = std::max(from_lamp, 0.0F);
  const float spread = aside_m * aside_m / (0.16F * reach * reach + 1.5F);
  const float beam = 1.0F / (1.0F + spread * spread);
  return beam * reach * reach * 6.0F / ((reach * reach + 9.0F) * (0.09F * reach * reach + 20.0F));
}

}  // namespace bevloc::sim
