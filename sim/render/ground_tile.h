// Sizes and format of the texture tiles of the ground.
#pragma once

#include <cstdint>

namespace bevloc::sim {

/// A tile is a square of 128 x 128 texels. The texel size doubles from level to level.
inline constexpr int kTileShift = 7;
inline constexpr int kTileTexels = 1 << kTileShift;
/// A tile also holds the first nodes of its right and upper neighbours, so that interpolation never
/// leaves the tile.
inline constexpr int kTileNodes = kTileTexels + 1;
inline constexpr int kTileArea = kTileNodes * kTileNodes;
inline constexpr int kGroundLevels = 6;
inline constexpr double kFinestTexelM = 0.05;

constexpr double texel_size_m(int level) {
  return kFinestTexelM * (1 << level);
}
constexpr double tile_size_m(int level) {
  return kTileTexels * texel_size_m(level);
}

/// Identifies a tile. Its node (i, j) lies at (128 ix + i, 128 iy + j) * texel_size_m(level) in the
/// map.
struct TileKey {
  int level = 0;
  int64_t ix = 0;
  int64_t iy = 0;
  bool operator==(const TileKey&) const = default;
};

/// Four bytes, from the lowest: square roots of the red, green and blue albedo, then gloss (0 on
/// earth, 1 on a sealed road).
using GroundTexel = uint32_t;

}  // namespace bevloc::sim
