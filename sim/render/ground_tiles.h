// The painted ground of a world, made where it comes into view.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "sim/render/ground_painter.h"
#include "sim/render/ground_tile.h"

namespace bevloc::sim {

/// A fixed number of tiles that renderers of one world share: a tile that is lent stays as it is,
/// of the others those lent last are kept. A tile's texels depend on the world and its key alone.
/// Thread safe.
class GroundTiles {
 public:
  /// A rig of six cameras sees some 290 at one moment, one camera at most 100.
  static constexpr int kCapacity = 320;
  /// A renderer may hold that many at a time, and kCapacity / kMostHeld renderers may share them.
  static constexpr int kMostHeld = 128;

  /// The world must outlive it.
  explicit GroundTiles(const World& world);

  const World& world() const { return world_; }
  const GroundTexel* texels() const { return texels_.get(); }

  /// Lends a tile, painting it if it is not kept: the offset of its first texel from texels().
  int32_t borrow(const TileKey& key);
  void give_back(int32_t offset);

 private:
  struct Slot {
    TileKey key;
    uint64_t last_loan = 0;  ///< value of loans_ then
    int borrowers = 0;
  };

  Slot& slot_of(const TileKey& key);
  Slot& paint(const TileKey& key);

  const World& world_;
  std::mutex mutex_;  ///< guards all below but the texels of lent tiles
  GroundPainter painter_;
  std::unique_ptr<GroundTexel[]> texels_;
  std::vector<Slot> slots_;
  uint64_t loans_ = 0;
};

}  // namespace bevloc::sim
