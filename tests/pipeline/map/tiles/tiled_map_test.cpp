#include "pipeline/map/tiles/tiled_map.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/map_loader.h"
#include "sim/random.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

/// Lines of all classes over 2 km x 2 km, on both sides of zero; two have no segment.
HdMap wide_map() {
  sim::Random random(5);
  HdMap map;
  map.name = "wide";
  map.origin = {49.0, 8.4};
  for (int i = 0; i < 300; ++i) {
    MapElement element;
    element.element_class = static_cast<ElementClass>(i % 3);
    element.appearance = i % 3 == 1 ? Appearance::kZebra : Appearance::kUnknown;
    Eigen::Vector2d point(random.uniform(-1000.0, 1000.0), random.uniform(-1000.0, 1000.0));
    const double step_m = i % 3 == 1 ? 4.0 : i % 50 == 0 ? 400.0 : 20.0;
    const int count = static_cast<int>(random.integer(2, 12));
    for (int p = 0; p < count; ++p) {
      element.points.push_back(point);
      point += Eigen::Vector2d(random.uniform(-step_m, step_m), random.uniform(-step_m, step_m));
    }
    map.elements.push_back(element);
  }
  map.elements[7].points.resize(1);
  map.elements[9].points.clear();
  map.lanes = {{{{0, 4}, {50, 4}}, {{0, 0}, {50, 0}}, {{0, 2}, {50, 2}}, {0}, 13.9}};
  return map;
}

std::string tile_error(std::string_view bytes) {
  const auto map = decode_map(bytes, "wide.bvm");
  return map ? "" : map.error().message;
}

TEST(TileCodec, ARoundTripIsThatOfVersion1) {
  const HdMap map = wide_map();
  const auto tiled = decode_map(encode_tiles(map), "wide.bvm");
  ASSERT_TRUE(tiled.has_value()) << tiled.error().message;
  const HdMap plain = decode_map(encode_map(map), "wide.bvm").value();
  EXPECT_EQ(encode_map(*tiled), encode_map(plain)) << "bit for bit the same map";
  EXPECT_EQ(map_checksum(*tiled), map_checksum(map));
  EXPECT_EQ(encode_tiles(*tiled), encode_tiles(map));
}

TEST(TileCodec, RefusesEveryTruncationAndEveryFlippedByte) {
  HdMap map = wide_map();
  map.elements.resize(12);
  std::string bytes = encode_tiles(map);
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_map(std::string_view(bytes).substr(0, size), "t").has_value()) << size;
  }
  for (size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= '\x11';
    EXPECT_FALSE(decode_map(bytes, "t").has_value()) << i;
    bytes[i] ^= '\x11';
  }
}

TEST(TileCodec, ErrorsNameTheByte) {
  std::string bytes = encode_tiles(wide_map());
  const auto entry = TileDirectory::open(bytes, "wide.bvm")->entry(3);
  bytes[entry.offset] ^= 1;
  EXPECT_THAT(tile_error(bytes),
              HasSubstr(fmt::format("wide.bvm: byte {}: found a damaged tile", entry.offset)));
  bytes[20] ^= 1;
  EXPECT_THAT(tile_error(bytes), HasSubstr("wide.bvm: byte 0: found CRC-32"));
}

TileDirectory::Entry largest_tile(std::string_view bytes) {
  const auto directory = TileDirectory::open(bytes, "wide.bvm").value();
  TileDirectory::Entry largest = directory.entry(0);
  for (size_t i = 1; i < directory.size(); ++i) {
    if (directory.entry(i).size > largest.size) largest = directory.entry(i);
  }
  return largest;
}

class TiledMapTest : public testing::Test {
 protected:
  std::unique_ptr<TiledMap> open(const std::string& bytes) {
    EXPECT_TRUE(write_file(file_, bytes).has_value());
    auto opened = TiledMap::open(file_);
    EXPECT_TRUE(opened.has_value()) << opened.error().message;
    return std::move(*opened);
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "wide.bvm";
};

TEST_F(TiledMapTest, QueriesAgreeWithTheIndexInMemory) {
  const HdMap map = decode_map(encode_map(wide_map()), "wide.bvm").value();
  const auto tiled = open(encode_tiles(map));
  EXPECT_EQ(tiled->facts().name, "wide");
  EXPECT_EQ(tiled->facts().checksum, map_checksum(map));
  EXPECT_EQ(tiled->facts().elements, 300U);
  const MapIndex index(map);
  std::vector<MapIndex::Segment> wanted;
  std::vector<TiledMap::Segment> found;
  sim::Random random(6);
  size_t compared = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d low(random.uniform(-1100.0, 1100.0), random.uniform(-1100.0, 1100.0));
    const Eigen::Vector2d high = low + Eigen::Vector2d(70.0, 70.0);
    index.query(low, high, wanted);
    tiled->query(low, high, found);
    size_t next = 0;
    for (const auto& segment : wanted) {
      const auto& points = map.elements[segment.element].points;
      const Eigen::Vector2d from = points[segment.first];
      const Eigen::Vector2d to = points[(segment.first + 1) % points.size()];
      const bool here = next < found.size() && found[next].element == segment.element &&
                        found[next].first == segment.first;
      if (here) {
        EXPECT_EQ(found[next].from, from);
        EXPECT_EQ(found[next].to, to);
        EXPECT_EQ(found[next].element_class, map.elements[segment.element].element_class);
        ++next;
        ++compared;
        continue;
      }
      // The tiles may leave out a segment only if it misses the box.
      for (double t = 0.0; t <= 1.0; t += 0.001) {
        const Eigen::Vector2d point = from + t * (to - from);
        const bool inside =
            (point.array() > low.array()).all() && (point.array() < high.array()).all();
        ASSERT_FALSE(inside) << "element " << segment.element << " point " << segment.first;
      }
    }
    EXPECT_EQ(next, found.size()) << "nothing that the index does not find";
  }
  EXPECT_GT(compared, 300U);
  tiled->query({-1e7, -1e7}, {1e7, 1e7}, found);
  index.query({-1e7, -1e7}, {1e7, 1e7}, wanted);
  EXPECT_EQ(found.size(), wanted.size());
}

TEST_F(TiledMapTest, ADamagedTileCountsAsEmpty) {
  std::string bytes = encode_tiles(wide_map());
  const TileDirectory::Entry entry = largest_tile(bytes);
  const Eigen::Vector2d corner = kTileSize_m * Eigen::Vector2d(entry.column, entry.row);
  const Eigen::Vector2d low = corner + Eigen::Vector2d(1.0, 1.0);
  const Eigen::Vector2d high = corner + Eigen::Vector2d(kTileSize_m - 1.0, kTileSize_m - 1.0);
  std::vector<TiledMap::Segment> found;
  open(bytes)->query(low, high, found);
  ASSERT_GE(found.size(), 3U);
  // The last byte belongs to the last point, so only the checksum tells that the tile is damaged.
  bytes[entry.offset + entry.size - 1] ^= 1;
  const auto tiled = open(bytes);
  EXPECT_EQ(tiled->damaged_tiles(), 0U) << "opening does not read tiles";
  tiled->query(low, high, found);
  EXPECT_TRUE(found.empty());
  tiled->query(low, high, found);
  EXPECT_TRUE(found.empty());
  EXPECT_EQ(tiled->damaged_tiles(), 1U) << "counted once";
}

TEST_F(TiledMapTest, OpenRefusesWhatIsNoMap) {
  EXPECT_THAT(TiledMap::open(folder_ / "none.bvm").error().message,
              HasSubstr("none.bvm: found no readable file"));
  ASSERT_TRUE(write_file(file_, encode_map(wide_map())).has_value());
  EXPECT_THAT(TiledMap::open(file_).error().message,
              HasSubstr("wanted a compact map of version 2"));
}

TEST_F(TiledMapTest, LoadMapReadsBothVersions) {
  ASSERT_TRUE(write_file(file_, encode_tiles(wide_map())).has_value());
  EXPECT_EQ(load_map(file_).value().elements.size(), 300U);
}

}  // namespace
}  // namespace bevloc
