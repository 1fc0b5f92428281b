// The image while it is drawn: linear light in planes.
#pragma once

#include <vector>

namespace bevloc::sim {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<float> red, green, blue;
  /// 1 / z of what stands nearest in the camera frame; 0 for ground and sky.
  std::vector<float> nearness;
  std::vector<float> scratch;  ///< a few rows

  void resize(int width_px, int height_px) {
    width = width_px;
    height = height_px;
    const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
    for (auto* plane : {&red, &green, &blue, &nearness}) plane->resize(count);
  }
};

/// Pixels are handled in runs of this many at most, whose intermediate values stay in the cache.
inline constexpr int kRun = 64;

}  // namespace bevloc::sim
