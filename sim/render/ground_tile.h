// The shape of the ground's texture tiles.
#pragma once

#include <cstdint>

namespace bevloc::sim {

/// Tiles of a level are squares of 128 texels; texel size doubles from level to level.
inline constexpr int kTileShift = 7;
inline constexpr int kTileTexels = 1 << kTileShift;
/// A tile holds its right and upper neighbours' first nodes too: interpolation never leaves it.
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

/// Node (i, j) of the tile lies at ((128 ix + i), (128 iy + j)) * texel_size_m(level) in the map.
struct TileKey {
  int level = 0;
  int64_t ix = 0;
  int64_t iy = 0;
  bool operator==(const TileKey&) const = default;
};

/// Square roots of the albedo's red, green and blue, then gloss (0 dull earth, 1 sealed road),
/// from the low byte up.
using GroundTexel = uint32_t;

}  // namespace bevloc::sim
