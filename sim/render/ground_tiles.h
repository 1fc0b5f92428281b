// The painted ground around a camera, made as it comes into view.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "sim/render/ground_painter.h"
#include "sim/render/ground_tile.h"

namespace bevloc::sim {

/// Keeps the newest kCapacity tiles. The pixel loops find a tile through a small directory that
/// wraps around: it holds every tile within kReachTiles of the centre, at every level.
class GroundTiles {
 public:
  static constexpr int kCapacity = 768;
  static constexpr int kDirectorySide = 32;
  static constexpr int kReachTiles = kDirectorySide / 2 - 1;
  static constexpr int kDirectorySize = kGroundLevels * kDirectorySide * kDirectorySide;
  static constexpr int32_t kMissing = -1;

  explicit GroundTiles(const World& world);

  /// Points the directory at the tiles around `centre` (map frame).
  void look_at(const Eigen::Vector2d& centre);

  /// The map position that local coordinates count from: a corner of the coarsest grid near the
  /// centre, so that floats hold local coordinates to well under a millimetre.
  Eigen::Vector2d local_origin() const;

  /// Place in the directory of a tile given by its level and its local tile coordinates.
  static constexpr int32_t directory_index(int32_t level, int32_t tile_x, int32_t tile_y) {
    constexpr int32_t kMask = kDirectorySide - 1;
    return (level * kDirectorySide + (tile_y & kMask)) * kDirectorySide + (tile_x & kMask);
  }
  /// Offset of each tile's first texel from texels(), or kMissing.
  const int32_t* directory() const { return directory_.data(); }
  const GroundTexel* texels() const { return texels_.get(); }

  /// Paints a missing tile, given by its level and local tile coordinates.
  void make(int level, int32_t tile_x, int32_t tile_y);

 private:
  bool in_reach(const TileKey& key) const;
  int32_t& entry(const TileKey& key);

  GroundPainter painter_;
  std::unique_ptr<GroundTexel[]> texels_;
  std::vector<TileKey> slots_;  ///< which tile each slot holds; the oldest is replaced first
  size_t next_slot_ = 0;
  std::array<int32_t, kDirectorySize> directory_{};
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  int64_t origin_ix_ = 0;  ///< of local_origin(), in tiles of the coarsest level
  int64_t origin_iy_ = 0;
};

}  // namespace bevloc::sim
