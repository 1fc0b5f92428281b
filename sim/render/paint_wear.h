// How much of a painted line the traffic has left.
#pragma once

#include <algorithm>

namespace bevloc::sim {

/// Paint goes where a noise field lies below a threshold that rises with wear.
class PaintWear {
 public:
  /// 0 fresh to 1 gone.
  explicit PaintWear(float wear) : threshold_(1.3F * wear - 0.4F), fade_(1.0F - 0.25F * wear) {}

  /// Share of the paint kept, from the ground noise at the place.
  float kept(float grain, float patches) const {
    const float strength = 0.5F + 0.17F * grain + 0.13F * patches;
    return std::clamp(4.0F * (strength - threshold_) + 0.5F, 0.0F, 1.0F);
  }
  /// Factor on the paint's albedo.
  float shade(float grain) const { return fade_ * (1.0F + 0.05F * grain); }

 private:
  float threshold_;
  float fade_;
};

/// 1 on asphalt, 0 on all else; from the canvas's gloss.
inline float sealed_road(float gloss) {
  return std::clamp(5.0F * gloss - 4.0F, 0.0F, 1.0F);
}

}  // namespace bevloc::sim
