// 8-bit RGB images: RgbImage owns its pixels, RgbView borrows them.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace bevloc {

/// A borrowed RGB image: interleaved R, G, B, row by row from the top left pixel.
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

/// Allocator that skips zero-initialisation, so that resize() does not touch memory.
template <typename T>
struct UninitializedAllocator : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = UninitializedAllocator<U>;
  };

  template <typename U, typename... Values>
  void construct(U* element, Values&&... values) {
    if constexpr (sizeof...(Values) == 0) {
      ::new (static_cast<void*>(element)) U;
    } else {
      ::new (static_cast<void*>(element)) U(std::forward<Values>(values)...);
    }
  }
};

using Pixels = std::vector<uint8_t, UninitializedAllocator<uint8_t>>;

/// An RGB image that owns its pixels, without padding between rows.
struct RgbImage {
  int width = 0;
  int height = 0;
  Pixels pixels;

  RgbImage() = default;
  /// Creates a black image.
  RgbImage(int width_px, int height_px)
      : width(width_px), height(height_px), pixels(size_of(width_px, height_px), uint8_t{0}) {}

  /// Creates an image with undefined pixels. Its memory is not resident until something is drawn.
  static RgbImage uninitialized(int width_px, int height_px) {
    RgbImage image;
    image.width = width_px;
    image.height = height_px;
    image.pixels.resize(size_of(width_px, height_px));
    return image;
  }

  uint8_t* row(int v) { return pixels.data() + 3 * static_cast<size_t>(width) * v; }
  const uint8_t* row(int v) const { return pixels.data() + 3 * static_cast<size_t>(width) * v; }
  RgbView view() const {
    return {pixels.data(), width, height, 3 * static_cast<std::ptrdiff_t>(width)};
  }

 private:
  static size_t size_of(int width_px, int height_px) {
    return 3 * static_cast<size_t>(width_px) * static_cast<size_t>(height_px);
  }
};

}  // namespace bevloc
