#include "sim/render/ground_tiles.h"

#include <cmath>

namespace bevloc::sim {
namespace {

constexpr int kCoarsest = kGroundLevels - 1;

int64_t tile_index(double position_m, int level) {
  return static_cast<int64_t>(std::floor(position_m / tile_size_m(level)));
}

}  // namespace

GroundTiles::GroundTiles(const World& world)
    : painter_(world),
      texels_(std::make_unique_for_overwrite<GroundTexel[]>(static_cast<size_t>(kCapacity) *
                                                            kTileArea)) {
  slots_.reserve(kCapacity);
}

void GroundTiles::look_at(const Eigen::Vector2d& centre) {
  centre_ = centre;
  origin_ix_ = tile_index(centre.x(), kCoarsest);
  origin_iy_ = tile_index(centre.y(), kCoarsest);
  directory_.fill(kMissing);
  for (size_t slot = 0; slot < slots_.size(); ++slot) {
    if (in_reach(slots_[slot])) entry(slots_[slot]) = static_cast<int32_t>(slot) * kTileArea;
  }
}

Eigen::Vector2d GroundTiles::local_origin() const {
  return {static_cast<double>(origin_ix_) * tile_size_m(kCoarsest),
          static_cast<double>(origin_iy_) * tile_size_m(kCoarsest)};
}

bool GroundTiles::in_reach(const TileKey& key) const {
  return std::abs(key.ix - tile_index(centre_.x(), key.level)) <= kReachTiles &&
         std::abs(key.iy - tile_index(centre_.y(), key.level)) <= kReachTiles;
}

int32_t& GroundTiles::entry(const TileKey& key) {
  const int64_t scale = int64_t{1} << (kCoarsest - key.level);
  return directory_[static_cast<size_t>(
      directory_index(key.level, static_cast<int32_t>(key.ix - origin_ix_ * scale),
                      static_cast<int32_t>(key.iy - origin_iy_ * scale)))];
}

void GroundTiles::make(int level, int32_t tile_x, int32_t tile_y) {
  const int64_t scale = int64_t{1} << (kCoarsest - level);
  const TileKey key{level, tile_x + origin_ix_ * scale, tile_y + origin_iy_ * scale};
  if (slots_.size() < kCapacity) {
    slots_.push_back(key);
  } else {
    if (in_reach(slots_[next_slot_])) entry(slots_[next_slot_]) = kMissing;
    slots_[next_slot_] = key;
  }
  const auto offset = static_cast<int32_t>(next_slot_) * kTileArea;
  next_slot_ = (next_slot_ + 1) % kCapacity;
  painter_.paint(key, texels_.get() + offset);
  entry(key) = offset;
}

}  // namespace bevloc::sim
