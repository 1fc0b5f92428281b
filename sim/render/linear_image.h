// The image during rendering: linear radiance in float planes.
#pragma once

#include <vector>

namespace bevloc::sim {

/// Linear radiance after exposure, row by row; 1 is full scale.
struct LinearImage {
  int width = 0;
  int height = 0;
  std::vector<float> red, green, blue;
  /// 1 / z in the camera frame (1/m) of the nearest panel or curved ground; 0 for flat ground and
  /// sky.
  std::vector<float> nearness;
  std::vector<float> scratch;  ///< a few rows of intermediate values

  void resize(int width_px, int height_px) {
    width = width_px;
    height = height_px;
    const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
    for (auto* plane : {&red, &green, &blue, &nearness}) plane->resize(count);
  }
};

/// The passes handle at most this many pixels at a time, so that intermediate values stay in the
/// cache.
inline constexpr int kRun = 64;

}  // namespace bevloc::sim
