// An 8-bit grey image.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/image.h"

namespace bevloc {

struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;  ///< row by row

  bool contains(double u, double v) const {
    return u >= 0.0 && v >= 0.0 && u <= width - 1.0 && v <= height - 1.0;
  }

  /// Returns the bilinear interpolation. The place must be inside (contains()); (0, 0) is the
  /// centre of the first pixel.
  float at(double u, double v) const {
    const int left = std::min(static_cast<int>(u), width - 2);
    const int top = std::min(static_cast<int>(v), height - 2);
    const auto a = static_cast<float>(u - left);
    const auto b = static_cast<float>(v - top);
    const uint8_t* p = pixels.data() + static_cast<size_t>(top) * width + left;
    const uint8_t* q = p + width;
    return (1.0F - b) * ((1.0F - a) * p[0] + a * p[1]) + b * ((1.0F - a) * q[0] + a * q[1]);
  }
};

/// The luma of ITU-R BT.601, with weights rounded to 1/256. The image must have at least 2 x 2
/// pixels.
inline GreyImage grey_from(const RgbView& rgb) {
  GreyImage grey{rgb.width, rgb.height, {}};
  grey.pixels.reserve(static_cast<size_t>(rgb.width) * rgb.height);
  for (int v = 0; v < rgb.height; ++v) {
    const uint8_t* p = rgb.row(v);
    for (int u = 0; u < rgb.width; ++u, p += 3) {
      grey.pixels.push_back(static_cast<uint8_t>((77 * p[0] + 150 * p[1] + 29 * p[2]) >> 8));
    }
  }
  return grey;
}

}  // namespace bevloc
