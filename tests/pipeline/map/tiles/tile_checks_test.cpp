// Files of version 2 that are wrong although all their checksums are right: one case for each check
// that reading makes.
#include <bit>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/tiles/tiled_map.h"
#include "tests/pipeline/map/tiles/tile_file_changes.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

// The maps below are so small that each number of a piece takes one byte: the step from the element
// before, the number of the first point, the look, the count of points, and their coordinates.
constexpr size_t kPieceStep = 0;
constexpr size_t kPieceFirst = 1;
constexpr size_t kPieceLook = 2;
constexpr size_t kPieceCount = 3;
constexpr size_t kPieceX = 4;
constexpr size_t kPieceSize = 8;  // with two points

char look_of(ElementClass element_class, Appearance appearance) {
  return static_cast<char>(static_cast<unsigned>(element_class) | static_cast<unsigned>(appearance)
                                                                      << 2U);
}

HdMap map_of_lines(const std::vector<std::vector<Eigen::Vector2d>>& lines) {
  HdMap map;
  map.name = "small";
  map.origin = {49.0, 8.4};
  for (const auto& points : lines) {
    map.elements.push_back({ElementClass::kLaneDivider, Appearance::kSolid, points});
  }
  return map;
}

/// Three lines in one tile.
std::string one_tile() {
  return encode_tiles(map_of_lines(
      {{{0.01, 0.01}, {0.04, 0.01}}, {{0.01, 0.02}, {0.04, 0.02}}, {{0.01, 0.03}, {0.04, 0.03}}}));
}

/// A line in two tiles.
std::string two_tiles() {
  return encode_tiles(map_of_lines({{{127.99, 0.01}, {128.01, 0.01}}}));
}

/// A line in one tile, and an element of one point in the rest.
std::string one_point() {
  return encode_tiles(map_of_lines({{{0.01, 0.01}, {0.04, 0.01}}, {{0.02, 0.02}}}));
}
// The rest of one_point(): the count of its elements, then the one element.
constexpr size_t kRestIndex = 1;
constexpr size_t kRestClass = 2;
constexpr size_t kRestAppearance = 3;
constexpr size_t kRestPoints = 4;
constexpr size_t kRestEnd = 7;  // where the element ends

size_t entry_place(const std::string& bytes, size_t index) {
  return test::tile_entry_place(test::tile_header_of(bytes), index);
}

size_t tile_place(const std::string& bytes, size_t index) {
  return fixed_at<uint64_t>(bytes, entry_place(bytes, index) + test::kEntryOffset);
}

size_t rest_place(const std::string& bytes) {
  return test::tile_header_of(bytes).rest_offset;
}

struct Damage {
  const char* what;
  void (*apply)(std::string& bytes);
  const char* message;
};

std::string damaged(std::string bytes, const Damage& damage) {
  damage.apply(bytes);
  test::state_tile_checksums(bytes);
  return bytes;
}

std::string message_for(const std::string& bytes) {
  const auto map = decode_map(bytes, "small.bvm");
  return map ? "accepted" : map.error().message;
}

void expect_refused(const std::string& bytes, const std::vector<Damage>& damages) {
  ASSERT_EQ(message_for(bytes), "accepted");
  for (const Damage& damage : damages) {
    EXPECT_THAT(message_for(damaged(bytes, damage)), HasSubstr(damage.message)) << damage.what;
  }
}

TEST(TileChecks, StatedAgainSizesAndChecksumsAreThoseOfTheWriter) {
  const std::string bytes = two_tiles();
  std::string again = bytes;
  for (const size_t place : {test::kEntryCrc, test::kEntryCrc + kTileEntrySize}) {
    test::put_fixed(again, entry_place(bytes, 0) + place, uint32_t{1});
  }
  test::change_tile_header(again, [](TileHeader& header) {
    header.file_size = header.rest_size = 1;
    header.rest_crc = header.directory_crc = 1;
  });
  EXPECT_NE(again, bytes);
  test::state_tile_sizes(again);
  test::state_tile_checksums(again);
  EXPECT_EQ(again, bytes);
}

TEST(TileChecks, AHeaderThatDoesNotFitTheFileIsRefused) {
  constexpr const char* kParts = "found a header whose parts are not within the file";
  const auto header = []<typename Change>(Change) {
    return [](std::string& bytes) { test::change_tile_header(bytes, Change{}); };
  };
  expect_refused(
      one_tile(),
      {{"the size of the file", header([](TileHeader& h) { ++h.file_size; }),
        "as its header states"},
       {"a directory beyond the file", header([](TileHeader& h) { h.tiles = 1000; }), kParts},
       {"a rest in the directory", header([](TileHeader& h) {
          h.rest_offset = kTileHeaderSize;
          h.rest_size = h.file_size - h.rest_offset;
        }),
        kParts},
       {"a rest beyond the file", header([](TileHeader& h) {
          h.rest_offset = h.file_size + 1;
          h.rest_size = h.file_size - h.rest_offset;  // wraps around
        }),
        kParts},
       {"the size of the rest", header([](TileHeader& h) { ++h.rest_size; }), kParts},
       {"the size of a tile", header([](TileHeader& h) { h.tile_quanta /= 2; }), kParts},
       {"more elements than bytes", header([](TileHeader& h) { h.elements = 1000; }),
        "found 1000 elements in"},
       {"the number of lanes", header([](TileHeader& h) { ++h.lanes; }),
        "found another number of lanes"},
       {"the number of dividers", header([](TileHeader& h) {
          --h.of_class[static_cast<size_t>(ElementClass::kLaneDivider)];
        }),
        "found other numbers of elements"},
       {"the checksum of the map", header([](TileHeader& h) { ++h.checksum; }), "found checksum"}});
}

TEST(TileChecks, AnOriginThatIsNotOnEarthIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [latitude_deg, longitude_deg] :
       {std::pair(90.5, 8.4), std::pair(nan, 8.4), std::pair(49.0, -180.5), std::pair(49.0, nan)}) {
    std::string bytes = one_tile();
    test::change_tile_header(
        bytes, [&, latitude = latitude_deg, longitude = longitude_deg](TileHeader& header) {
          header.latitude_bits = std::bit_cast<uint64_t>(latitude);
          header.longitude_bits = std::bit_cast<uint64_t>(longitude);
        });
    test::state_tile_checksums(bytes);
    EXPECT_THAT(message_for(bytes), HasSubstr("found an origin that is not on earth"));
  }
}

TEST(TileChecks, ADirectoryThatDoesNotFitTheTilesIsRefused) {
  constexpr const char* kBeyond = "of the directory beyond the tiles";
  constexpr const char* kOrder = "found entry 1 of the directory out of order";
  expect_refused(
      two_tiles(),
      {{"a tile that begins before the tiles",
        [](std::string& bytes) {
          test::put_fixed(bytes, entry_place(bytes, 0) + test::kEntryOffset,
                          uint64_t{tile_place(bytes, 0) - 1});
        },
        kBeyond},
       {"a tile that begins after the tiles",
        [](std::string& bytes) {
          test::put_fixed(bytes, entry_place(bytes, 1) + test::kEntryOffset,
                          uint64_t{rest_place(bytes) + 1});
        },
        kBeyond},
       {"a tile that ends after the tiles",
        [](std::string& bytes) {
          test::put_fixed(bytes, entry_place(bytes, 1) + test::kEntrySize,
                          static_cast<uint32_t>(kPieceSize + 1));
        },
        kBeyond},
       {"tiles in another order",
        [](std::string& bytes) {
          const size_t place = entry_place(bytes, 0);
          const std::string first = bytes.substr(place, kTileEntrySize);
          bytes.erase(place, kTileEntrySize).insert(place + kTileEntrySize, first);
        },
        kOrder},
       {"a row below the row before",
        [](std::string& bytes) {
          test::put_fixed(bytes, entry_place(bytes, 1) + test::kEntryRow, uint32_t{0} - 1);
        },
        kOrder},
       {"a tile twice",
        [](std::string& bytes) {
          test::put_fixed(bytes, entry_place(bytes, 1) + test::kEntryColumn, uint32_t{0});
        },
        kOrder},
       {"a tile over the tile before it",
        [](std::string& bytes) {
          test::put_fixed(bytes, entry_place(bytes, 1) + test::kEntryOffset,
                          uint64_t{tile_place(bytes, 1) - 1});
        },
        "found entry 1 of the directory over the tile before it"}});
}

/// Pieces that no map can have. A tile with such a piece is damaged.
std::vector<Damage> wrong_pieces() {
  constexpr const char* kDamaged = "found a damaged tile";
  return {
      {"an element beyond the last",  // each step is below the number of elements, the sum is not
       [](std::string& bytes) { bytes[tile_place(bytes, 0) + 2 * kPieceSize + kPieceStep] = 2; },
       kDamaged},
      {"an unknown class",
       [](std::string& bytes) {
         bytes[tile_place(bytes, 0) + kPieceLook] =
             look_of(static_cast<ElementClass>(kElementClasses), Appearance::kSolid);
       },
       kDamaged},
      {"an unknown appearance",
       [](std::string& bytes) {
         bytes[tile_place(bytes, 0) + kPieceLook] =
             look_of(ElementClass::kLaneDivider, static_cast<Appearance>(kAppearances));
       },
       kDamaged},
      {"more points than the tile has",
       [](std::string& bytes) { bytes[tile_place(bytes, 0) + 2 * kPieceSize + kPieceCount] = 3; },
       kDamaged},
      {"points too far away",
       [](std::string& bytes) {
         test::put_fixed(bytes, entry_place(bytes, 0) + test::kEntryColumn,
                         static_cast<uint32_t>(std::numeric_limits<int32_t>::max()));
       },
       kDamaged}};
}

TEST(TileChecks, APieceThatNoMapCanHaveIsRefused) {
  expect_refused(one_tile(), wrong_pieces());
}

TEST(TileChecks, ATileOnDiskWithAPieceThatNoMapCanHaveCountsAsEmpty) {
  const test::TemporaryFolder folder;
  const auto query_all = [&folder](const std::string& bytes) {
    const std::filesystem::path file = folder / "small.bvm";
    EXPECT_TRUE(write_file(file, bytes).has_value());
    const auto map = TiledMap::open(file).value();
    std::vector<TiledMap::Segment> found;
    map->query({-1e7, -1e7}, {1e7, 1e7}, found);
    return std::pair(found.size(), map->damaged_tiles());
  };
  EXPECT_EQ(query_all(one_tile()), std::pair(size_t{3}, size_t{0}));
  for (const Damage& damage : wrong_pieces()) {
    EXPECT_EQ(query_all(damaged(one_tile(), damage)), std::pair(size_t{0}, size_t{1}))
        << damage.what;
  }
}

TEST(TileChecks, PiecesOfOneElementThatDoNotFitAreRefused) {
  constexpr const char* kUnfit = "found pieces of element 0 that do not fit";
  expect_refused(
      two_tiles(),
      {{"another class",
        [](std::string& bytes) {
          bytes[tile_place(bytes, 1) + kPieceLook] =
              look_of(ElementClass::kRoadBoundary, Appearance::kSolid);
        },
        kUnfit},
       {"another appearance",
        [](std::string& bytes) {
          bytes[tile_place(bytes, 1) + kPieceLook] =
              look_of(ElementClass::kLaneDivider, Appearance::kDashed);
        },
        kUnfit},
       {"a gap before the first point",
        [](std::string& bytes) { bytes[tile_place(bytes, 1) + kPieceFirst] = 3; }, kUnfit},
       {"another place of a point",  // a step of 1 mm is 2 in the file
        [](std::string& bytes) { bytes[tile_place(bytes, 1) + kPieceX] += 2; },
        "found two places of point 0 of element 0"}});
}

TEST(TileChecks, ARestThatNoMapCanHaveIsRefused) {
  constexpr const char* kImpossible = "found an element that no map can have";
  ASSERT_EQ(one_point().size(), rest_place(one_point()) + kRestEnd + 1) << "one byte for no lanes";
  expect_refused(
      one_point(),
      {{"an element beyond the last",
        [](std::string& bytes) { bytes[rest_place(bytes) + kRestIndex] = 2; },
        "found an element beyond the last"},
       {"an element that has pieces",
        [](std::string& bytes) { bytes[rest_place(bytes) + kRestIndex] = 0; }, kImpossible},
       {"an unknown class",
        [](std::string& bytes) {
          bytes[rest_place(bytes) + kRestClass] = static_cast<char>(kElementClasses);
        },
        kImpossible},
       {"an unknown appearance",
        [](std::string& bytes) {
          bytes[rest_place(bytes) + kRestAppearance] = static_cast<char>(kAppearances);
        },
        kImpossible},
       {"two points",
        [](std::string& bytes) {
          bytes[rest_place(bytes) + kRestPoints] = 2;
          bytes.insert(rest_place(bytes) + kRestEnd, 2, '\0');
          test::state_tile_sizes(bytes);
        },
        kImpossible},
       {"more bytes than the lanes take",
        [](std::string& bytes) {
          bytes += '\0';
          test::state_tile_sizes(bytes);
        },
        "found more bytes after the last lane"},
       {"more elements than bytes", [](std::string& bytes) { bytes[rest_place(bytes)] = 100; },
        "found a count that exceeds the body"}});
}

}  // namespace
}  // namespace bevloc
