// 8-bit RGB images, owned and borrowed.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bevloc {

/// A borrowed RGB image, interleaved, row by row from the top left pixel.
struct RgbView {
  const uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;

  const uint8_t* row(int v) const {
    assert(v >= 0 && v < height);
    return data + v * stride_bytes;
  }
};

/// An RGB image that owns its pixels, without padding between rows.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;

  RgbImage() = default;
  RgbImage(int width_px, int height_px)
      : width(width_px), height(height_px), pixels(3 * static_cast<size_t>(width_px) * height_px) {}

  uint8_t* row(int v) { return pixels.data() + 3 * static_cast<size_t>(width) * v; }
  const uint8_t* row(int v) const { return pixels.data() + 3 * static_cast<size_t>(width) * v; }
  RgbView view() const {
    return {pixels.data(), width, height, 3 * static_cast<std::ptrdiff_t>(width)};
  }
};

}  // namespace bevloc
