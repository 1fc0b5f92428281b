// The canvas on which a ground tile is painted.
#pragma once

#include <array>
#include <vector>

#include "sim/render/noise.h"
#include "sim/render/photo_library.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Albedo planes of one tile, with the ground noise at its place in the map. One thread.
struct TileCanvas {
  using Plane = std::vector<float>;

  TileCanvas();
  /// Starts a tile: sets its place, looks up the noise and sets the albedo to 0. From 0, full
  /// coverage gives exactly the value of the material, independent of earlier tiles.
  void begin(const TileKey& key, uint64_t world_seed);

  double texel_m() const { return texel_size_m(key.level); }
  double origin_x_m() const { return static_cast<double>(key.ix) * tile_size_m(key.level); }
  double origin_y_m() const { return static_cast<double>(key.iy) * tile_size_m(key.level); }
  /// Converts a map position to texels of this tile.
  Eigen::Vector2f texel(const Eigen::Vector2d& map) const {
    const double scale = 1.0 / texel_m();
    return {static_cast<float>((map.x() - origin_x_m()) * scale),
            static_cast<float>((map.y() - origin_y_m()) * scale)};
  }
  /// GroundNoise::grain() along row j.
  const float* grain_row(int j) const;

  TileKey key;
  Plane red, green, blue, gloss;
  Plane patches;  ///< GroundNoise::patches() at every node
  /// Photographs of the materials; null where a material has noise alone.
  std::array<const GroundPhoto*, kGroundMaterials> photos{};

 private:
  void look_up_patches(int j);

  int64_t noise_shift_x_ = 0;  ///< in texels; differs between worlds
  int64_t noise_shift_y_ = 0;
};

/// Pointers into one row of a canvas, starting at some column.
struct CanvasRow {
  float* red;
  float* green;
  float* blue;
  float* gloss;
  const float* grain;
  const float* patches;
};
/// Row j from column i on.
CanvasRow canvas_row(TileCanvas& canvas, int j, int i);

/// Covers row j with a material. `coverage` has kTileNodes values, or is null for full coverage.
void cover_with_material(TileCanvas& canvas, int j, GroundMaterial material, float brightness,
                         const float* coverage);

/// Covers row j with worn paint; `coverage` as above.
void cover_with_paint(TileCanvas& canvas, int j, const Rgb& albedo, float wear,
                      const float* coverage);

/// Multiplies the albedo of everything in row j by `light`; `coverage` as above.
void shade_row(TileCanvas& canvas, int j, float light, const float* coverage);

/// Multiplies the albedo of asphalt in row j by `factor`; `coverage` as above.
void darken_road(TileCanvas& canvas, int j, float factor, const float* coverage);

}  // namespace bevloc::sim
