// The ground tiles that one image shows.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sim/render/ground_tiles.h"

namespace bevloc::sim {

/// Borrows tiles while an image is rendered. The pixel loops find tiles in a small directory with
/// wrap-around, which has room for all tiles within kReachTiles of the centre at every level. One
/// thread, but several windows may share one GroundTiles.
class GroundWindow {
 public:
  static constexpr int kDirectorySide = 32;
  static constexpr int kReachTiles = kDirectorySide / 2 - 1;
  static constexpr int kDirectorySize = kGroundLevels * kDirectorySide * kDirectorySide;
  static constexpr int32_t kMissing = -1;

  explicit GroundWindow(std::shared_ptr<GroundTiles> tiles);
  ~GroundWindow() { close(); }
  GroundWindow(const GroundWindow&) = delete;
  GroundWindow& operator=(const GroundWindow&) = delete;

  /// Begins an image around `centre` (map frame). No tile is borrowed yet.
  void open(const Eigen::Vector2d& centre);
  /// Gives back all tiles.
  void close();

  const World& world() const { return tiles_->world(); }

  /// The map position of the local coordinates' origin: a corner of the coarsest tile grid near the
  /// centre, so that local coordinates in float are accurate to well below 1 mm.
  Eigen::Vector2d local_origin() const;

  /// Index in the directory of a tile, given by its level and its local tile coordinates.
  static constexpr int32_t directory_index(int32_t level, int32_t tile_x, int32_t tile_y) {
    constexpr int32_t kMask = kDirectorySide - 1;
    return (level * kDirectorySide + (tile_y & kMask)) * kDirectorySide + (tile_x & kMask);
  }
  /// Offset of each tile's first texel from texels(), or kMissing.
  const int32_t* directory() const { return directory_.data(); }
  const GroundTexel* texels() const { return tiles_->texels(); }

  /// Borrows a missing tile and enters it into the directory. Only the last GroundTiles::kMostHeld
  /// tiles are guaranteed to be there.
  void fetch(int level, int32_t tile_x, int32_t tile_y);

 private:
  /// Gives back the tile of held_[i].
  void give_back(size_t i);

  const std::shared_ptr<GroundTiles> tiles_;
  std::array<int32_t, kDirectorySize> directory_{};
  std::vector<int32_t> held_;  ///< directory indices; a ring buffer once kMostHeld is reached
  size_t oldest_ = 0;
  int64_t origin_ix_ = 0;  ///< index of local_origin(), in tiles of the coarsest level
  int64_t origin_iy_ = 0;
};

}  // namespace bevloc::sim
