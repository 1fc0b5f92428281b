#include "sim/render/ground_tiles.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace bevloc::sim {

GroundTiles::GroundTiles(const World& world)
    : world_(world),
      painter_(world),
      texels_(std::make_unique_for_overwrite<GroundTexel[]>(static_cast<size_t>(kCapacity) *
                                                            kTileArea)) {
  slots_.reserve(kCapacity);
}

int32_t GroundTiles::borrow(const TileKey& key) {
  const std::lock_guard lock(mutex_);
  Slot& slot = slot_of(key);
  ++slot.borrowers;
  slot.last_loan = ++loans_;
  return static_cast<int32_t>(&slot - slots_.data()) * kTileArea;
}

void GroundTiles::give_back(int32_t offset) {
  const std::lock_guard lock(mutex_);
  --slots_[static_cast<size_t>(offset / kTileArea)].borrowers;
}

GroundTiles::Slot& GroundTiles::slot_of(const TileKey& key) {
  const auto kept =
      std::find_if(slots_.begin(), slots_.end(), [&](const Slot& slot) { return slot.key == key; });
  return kept != slots_.end() ? *kept : paint(key);
}

GroundTiles::Slot& GroundTiles::paint(const TileKey& key) {
  if (slots_.size() < kCapacity) slots_.emplace_back();
  const auto lent_and_time = [](const Slot& slot) {
    return std::pair(slot.borrowers > 0, slot.last_loan);
  };
  Slot& slot = *std::min_element(slots_.begin(), slots_.end(), [&](const Slot& a, const Slot& b) {
    return lent_and_time(a) < lent_and_time(b);
  });
  assert(slot.borrowers == 0 && "too many renderers share the tiles");
  slot.key = key;
  painter_.paint(key, texels_.get() + (&slot - slots_.data()) * kTileArea);
  return slot;
}

}  // namespace bevloc::sim
