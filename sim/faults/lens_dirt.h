// Dirt on the lens of a simulated camera: soft opaque spots that stay in their place.
#pragma once

#include <cstdint>
#include <vector>

#include "common/image.h"

namespace bevloc::sim {

/// A pattern for one size of picture. One thread.
class LensDirt {
 public:
  /// Covers about `share` of the picture, or a little more.
  LensDirt(int width_px, int height_px, double share, uint64_t seed);

  /// Paints the dirt. It is as bright as the picture is on average, because the light behind it
  /// shines through.
  void cover(RgbImage& image) const;

  double share() const { return share_; }
  /// The share of light that the dirt stops, averaged over the picture.
  double covered() const;

 private:
  double share_;
  std::vector<float> opacity_;  ///< per pixel, 0 to 1
};

}  // namespace bevloc::sim
