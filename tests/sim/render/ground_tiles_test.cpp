#include "sim/render/ground_tiles.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/sim/render/small_world.h"

namespace bevloc::sim {
namespace {

using Tile = std::vector<GroundTexel>;

Tile texels_at(const GroundTiles& tiles, int32_t offset) {
  const GroundTexel* first = tiles.texels() + offset;
  return {first, first + kTileArea};
}

/// Borrows and gives back `count` other tiles, one after the other.
void borrow_others(GroundTiles& tiles, int count) {
  for (int i = 0; i < count; ++i) tiles.give_back(tiles.borrow({0, i, 1000}));
}

TEST(GroundTiles, PaintsEachTileInAPlaceOfItsOwn) {
  const World world = short_street();
  GroundTiles tiles(world);
  GroundPainter painter(world);
  Tile expected(kTileArea);
  std::vector<int32_t> offsets;
  for (const TileKey& key : {TileKey{0, 3, -1}, TileKey{0, -2, 0}, TileKey{2, 0, -1}}) {
    painter.paint(key, expected.data());
    offsets.push_back(tiles.borrow(key));
    EXPECT_EQ(texels_at(tiles, offsets.back()), expected);
    EXPECT_EQ(std::count(offsets.begin(), offsets.end(), offsets.back()), 1);
  }
}

TEST(GroundTiles, KeepsTheTilesBorrowedLast) {
  const World world = short_street();
  GroundTiles tiles(world);
  const TileKey key{0, 3, -1};
  const int32_t offset = tiles.borrow(key);
  tiles.give_back(offset);
  borrow_others(tiles, GroundTiles::kCapacity - 1);
  EXPECT_EQ(tiles.borrow(key), offset);
  tiles.give_back(offset);
  borrow_others(tiles, GroundTiles::kCapacity - 1);
  EXPECT_EQ(tiles.borrow(key), offset) << "the previous loan makes the tile recent again";
}

TEST(GroundTiles, ABorrowedTileStays) {
  const World world = short_street();
  GroundTiles tiles(world);
  const TileKey key{0, 3, -1};
  const int32_t offset = tiles.borrow(key);
  tiles.give_back(tiles.borrow(key));  // one borrower remains
  const Tile borrowed = texels_at(tiles, offset);
  borrow_others(tiles, 2 * GroundTiles::kCapacity);
  EXPECT_EQ(texels_at(tiles, offset), borrowed);
  EXPECT_EQ(tiles.borrow(key), offset);
}

TEST(GroundTiles, PaintsADroppedTileTheSameAgain) {
  const World world = short_street();
  GroundTiles tiles(world);
  const TileKey key{0, 3, -1};
  const int32_t offset = tiles.borrow(key);
  const Tile first = texels_at(tiles, offset);
  tiles.give_back(offset);
  borrow_others(tiles, GroundTiles::kCapacity);
  EXPECT_NE(texels_at(tiles, offset), first) << "another tile is in its place";
  EXPECT_EQ(texels_at(tiles, tiles.borrow(key)), first);
}

}  // namespace
}  // namespace bevloc::sim
