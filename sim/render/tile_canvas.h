// A ground tile while it is being painted.
#pragma once

#include <array>
#include <vector>

#include "sim/render/noise.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Albedo planes of one tile, with the noise that belongs to its place in the map.
struct TileCanvas {
  using Plane = std::vector<float>;

  TileCanvas();
  /// Sets the place, looks up the noise and blackens the albedo: covering a black texel gives the
  /// material's own value to the last bit, whatever the canvas showed before.
  void begin(const TileKey& key, uint64_t world_seed);

  double texel_m() const { return texel_size_m(key.level); }
  double origin_x_m() const { return static_cast<double>(key.ix) * tile_size_m(key.level); }
  double origin_y_m() const { return static_cast<double>(key.iy) * tile_size_m(key.level); }
  /// A map position in texels of this tile.
  Eigen::Vector2f texel(const Eigen::Vector2d& map) const {
    const double scale = 1.0 / texel_m();
    return {static_cast<float>((map.x() - origin_x_m()) * scale),
            static_cast<float>((map.y() - origin_y_m()) * scale)};
  }
  const float* grain_row(int j) const;

  TileKey key;
  Plane red, green, blue, gloss;
  Plane patches;  ///< GroundNoise::patches() at every node

 private:
  void look_up_patches(int j);

  int64_t noise_shift_x_ = 0;  ///< in texels; differs between worlds
  int64_t noise_shift_y_ = 0;
};

/// One row of a canvas, from some column on.
struct CanvasRow {
  float* red;
  float* green;
  float* blue;
  float* gloss;
  const float* grain;
  const float* patches;
};
CanvasRow canvas_row(TileCanvas& canvas, int j, int i);

/// Covers row j with a material. `coverage` has kTileNodes values, or is null for a full row.
void cover_with_material(TileCanvas& canvas, int j, GroundMaterial material, float brightness,
                         const float* coverage);

/// Covers row j with worn paint.
void cover_with_paint(TileCanvas& canvas, int j, const Rgb& albedo, float wear,
                      const float* coverage);

/// Darkens sealed road in row j where covered (tar patches).
void darken_road(TileCanvas& canvas, int j, float factor, const float* coverage);

}  // namespace bevloc::sim
