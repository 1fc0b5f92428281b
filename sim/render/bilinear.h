// Bilinear interpolation between four packed texels, written so that the compiler vectorises it.
#pragma once

#include <cstdint>

namespace bevloc::sim {

/// Four neighbouring texels and the interpolation point between them.
struct Neighbours {
  uint32_t low_left, low_right, high_left, high_right;
  float blend_x, blend_y;

  /// Interpolates the byte that starts at bit `shift`; 0 to 255.
  float channel(uint32_t shift) const {
    // Converting signed integers is cheaper than unsigned ones.
    const auto byte = [shift](uint32_t texel) {
      return static_cast<float>(static_cast<int32_t>((texel >> shift) & 255U));
    };
    const float low = byte(low_left) + blend_x * (byte(low_right) - byte(low_left));
    const float high = byte(high_left) + blend_x * (byte(high_right) - byte(high_left));
    return low + blend_y * (high - low);
  }
};

/// Loads the four texels around a point of a grid, by the index of the lower left one.
class NeighbourGrid {
 public:
  NeighbourGrid(const uint32_t* texels, int pitch)
      : low_left_(texels),
        low_right_(texels + 1),
        high_left_(texels + pitch),
        high_right_(texels + pitch + 1) {}

  Neighbours at(int32_t index, float blend_x, float blend_y) const {
    return {low_left_[index],   low_right_[index], high_left_[index],
            high_right_[index], blend_x,           blend_y};
  }

 private:
  const uint32_t* low_left_;
  const uint32_t* low_right_;
  const uint32_t* high_left_;
  const uint32_t* high_right_;
};

}  // namespace bevloc::sim
