// Computes how much paint is left on a worn marking.
#pragma once

#include <algorithm>

namespace bevloc::sim {

/// Paint is gone where a noise field is below a threshold that rises with wear.
class PaintWear {
 public:
  /// A `wear` of 0 is fresh, and 1 is gone.
  explicit PaintWear(float wear) : threshold_(1.3F * wear - 0.4F), fade_(1.0F - 0.25F * wear) {}

  /// Remaining share of the paint at a place with this ground noise, 0 to 1.
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

/// 1 on asphalt, 0 elsewhere, computed from the gloss of the canvas.
inline float sealed_road(float gloss) {
  return std::clamp(5.0F * gloss - 4.0F, 0.0F, 1.0F);
}

}  // namespace bevloc::sim
