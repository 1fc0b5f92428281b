// The part of the painted ground that one picture shows.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sim/render/ground_tiles.h"

namespace bevloc::sim {

/// Borrows tiles while a picture is drawn. The pixel loops find a tile through a small directory
/// that wraps around: it has room for every tile within kReachTiles of the centre, at every level.
/// Not thread safe; its GroundTiles are.
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

  /// Begins a picture around `centre` (map frame), with no tile borrowed.
  void open(const Eigen::Vector2d& centre);
  /// Gives all tiles back.
  void close();

  const World& world() const { return tiles_->world(); }

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
  const GroundTexel* texels() const { return tiles_->texels(); }

  /// Enters a missing tile into the directory. Only the GroundTiles::kMostHeld entered last are
  /// sure to be there.
  void fetch(int level, int32_t tile_x, int32_t tile_y);

 private:
  /// Ends the loan of the i-th of held_.
  void give_back(size_t i);

  const std::shared_ptr<GroundTiles> tiles_;
  std::array<int32_t, kDirectorySize> directory_{};
  std::vector<int32_t> held_;  ///< places in the directory; beyond kMostHeld a ring
  size_t oldest_ = 0;
  int64_t origin_ix_ = 0;  ///< of local_origin(), in tiles of the coarsest level
  int64_t origin_iy_ = 0;
};

}  // namespace bevloc::sim
