// A cache of painted ground tiles that renderers of one world share.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "sim/render/ground_painter.h"
#include "sim/render/ground_tile.h"

namespace bevloc::sim {

/// A least-recently-used cache with a fixed number of tiles. Renderers borrow tiles; a borrowed
/// tile does not change. The texels of a tile depend on the world and its key alone. Thread-safe.
class GroundTiles {
 public:
  /// The six cameras together see about 290 tiles at one moment, one camera at most 100.
  static constexpr int kCapacity = 320;
  /// One renderer may hold this many at a time; kCapacity / kMostHeld renderers may share the
  /// cache.
  static constexpr int kMostHeld = 128;

  /// The world must outlive the tiles.
  explicit GroundTiles(const World& world);

  const World& world() const { return world_; }
  const GroundTexel* texels() const { return texels_.get(); }

  /// Borrows a tile and paints it if it is not in the cache. Returns the offset of its first texel
  /// from texels(). Each call needs a give_back() with that offset.
  int32_t borrow(const TileKey& key);
  void give_back(int32_t offset);

 private:
  struct Slot {
    TileKey key;
    uint64_t last_loan = 0;  ///< loans_ at the last borrow()
    int borrowers = 0;
  };

  Slot& slot_of(const TileKey& key);
  Slot& paint(const TileKey& key);

  const World& world_;
  std::mutex mutex_;  ///< guards all members below, except the texels of borrowed tiles
  GroundPainter painter_;
  std::unique_ptr<GroundTexel[]> texels_;
  std::vector<Slot> slots_;
  uint64_t loans_ = 0;
};

}  // namespace bevloc::sim
