// Photographs of surfaces, which replace the simulator's own textures.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "common/result.h"
#include "sim/render/ground_tile.h"
#include "sim/render/texture.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Photographed ground relative to its mean, so that a material keeps its usual albedo.
class GroundPhoto {
 public:
  /// Level 0 has the finest texels of the ground. The side is a power of two from 64 to 256, and
  /// the photograph repeats.
  GroundPhoto(int side_px, std::vector<Rgb> finest);

  /// Writes the factors on the albedo along row (ix ... ix + count - 1, iy) of a ground level.
  void copy_row(int level, int64_t ix, int64_t iy, int count, float* red, float* green,
                float* blue) const;

 private:
  int side_px_;
  std::array<std::vector<Rgb>, kGroundLevels> levels_;
};

/// Immutable after load(), and so thread-safe.
class PhotoLibrary {
 public:
  /// Reads `folder`/photos.txt, which `script/photos` writes: one line for each photograph with its
  /// use, PNG file, side in pixels and side in metres. Fails if the index or a photograph is
  /// missing or wrong.
  static Result<PhotoLibrary> load(const std::filesystem::path& folder);

  /// A photograph for the ground of a world. Returns null if the library has none, or if the seed
  /// chose the simulator's own texture.
  const GroundPhoto* ground(GroundMaterial material, uint64_t world_seed) const;

  /// A photograph for a wall or a tree's crown, chosen in the same way.
  const Texture* wall(WallTexture kind, uint64_t wall_seed) const;
  const Texture* crown(uint64_t tree_seed) const;

  /// Number of photographs.
  size_t size() const;

 private:
  Status add(std::string_view use, const std::filesystem::path& file, int side_px, double side_m);

  std::array<std::vector<GroundPhoto>, kGroundMaterials> ground_;
  std::array<std::vector<Texture>, kPatternCount> panels_;  ///< photographs of walls and crowns
};

}  // namespace bevloc::sim
