#include "pipeline/map/map_binary.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/crc32.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_loader.h"
#include "sim/random.h"
#include "tests/pipeline/map/framed_map.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using test::framed_map;
using testing::HasSubstr;
using testing::StartsWith;

/// A street of 1 km with two lanes and a crossing, with points every 2 m.
HdMap kilometre() {
  HdMap map;
  map.name = "kilometre";
  map.origin = {49.0123456789, 8.4};
  const auto line = [](double y, double step) {
    std::vector<Eigen::Vector2d> points;
    for (double x = 0.0; x <= 1000.0; x += step) points.emplace_back(x, y + std::sin(0.01 * x));
    return points;
  };
  map.elements = {
      {ElementClass::kRoadBoundary, Appearance::kKerb, line(-4.0, 2.0)},
      {ElementClass::kLaneDivider, Appearance::kDashed, line(0.0, 2.0)},
      {ElementClass::kRoadBoundary, Appearance::kHedge, line(4.0, 2.0)},
      {ElementClass::kPedestrianCrossing, Appearance::kZebra, {{9, -4}, {12, -4}, {12, 4}, {9, 4}}},
      {ElementClass::kLaneDivider, Appearance::kUnknown, {}},
  };
  map.lanes = {{line(0.0, 2.0), line(-4.0, 2.0), line(-2.0, 2.0), {1, 0}, 13.9},
               {line(0.0, 2.0), line(4.0, 2.0), line(2.0, 2.0), {}, 8.333333}};
  return map;
}

void expect_near(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_LE((a[i] - b[i]).cwiseAbs().maxCoeff(), 0.5 * kMapQuantumM + 1e-9);
  }
}

std::string decode_error(std::string_view bytes) {
  const auto map = decode_map(bytes, "town.bvm");
  EXPECT_FALSE(map.has_value());
  return map ? "" : map.error().message;
}

TEST(Crc32, MatchesTheCheckValueOfTheStandard) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926U);
}

TEST(MapChecksum, IsTheSameAfterARoundTripAndChangesWithTheContent) {
  const HdMap map = kilometre();
  const uint32_t checksum = map_checksum(map);
  EXPECT_EQ(map_checksum(decode_map(encode_map(map), "town.bvm").value()), checksum);

  HdMap other = map;
  other.name = "another name";
  EXPECT_EQ(map_checksum(other), checksum) << "the name is not content";
  other.elements[1].points[7].x() += 2.0 * kMapQuantumM;
  EXPECT_NE(map_checksum(other), checksum);
  other = map;
  other.elements[0].element_class = ElementClass::kLaneDivider;
  EXPECT_NE(map_checksum(other), checksum);
  other = map;
  other.origin.longitude_deg += 1e-9;
  EXPECT_NE(map_checksum(other), checksum);
  other = map;
  std::swap(other.elements[0], other.elements[2]);
  EXPECT_NE(map_checksum(other), checksum);
}

TEST(MapBinary, RoundTripsWithMillimetreAccuracy) {
  const HdMap map = kilometre();
  const auto again = decode_map(encode_map(map), "town.bvm");
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->name, map.name);
  EXPECT_EQ(again->origin.latitude_deg, map.origin.latitude_deg);
  EXPECT_EQ(again->origin.longitude_deg, map.origin.longitude_deg);
  ASSERT_EQ(again->elements.size(), map.elements.size());
  for (size_t i = 0; i < map.elements.size(); ++i) {
    EXPECT_EQ(again->elements[i].element_class, map.elements[i].element_class);
    EXPECT_EQ(again->elements[i].appearance, map.elements[i].appearance);
    expect_near(again->elements[i].points, map.elements[i].points);
  }
  ASSERT_EQ(again->lanes.size(), map.lanes.size());
  for (size_t i = 0; i < map.lanes.size(); ++i) {
    expect_near(again->lanes[i].left, map.lanes[i].left);
    expect_near(again->lanes[i].right, map.lanes[i].right);
    expect_near(again->lanes[i].centerline, map.lanes[i].centerline);
    EXPECT_EQ(again->lanes[i].successors, map.lanes[i].successors);
    EXPECT_EQ(again->lanes[i].speed_limit_mps, map.lanes[i].speed_limit_mps);
  }
  // Encoding again does not change the quantised points.
  EXPECT_EQ(encode_map(*again), encode_map(map));
}

TEST(MapBinary, AKilometreOfStreetIsSmall) {
  EXPECT_LT(encode_map(kilometre()).size(), 25'000U);
}

TEST(MapBinary, RoundTripsAnEmptyMap) {
  const auto map = decode_map(encode_map(HdMap{}), "town.bvm");
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_TRUE(map->elements.empty());
}

TEST(MapBinary, KeepsDistantPoints) {
  HdMap map;
  map.elements = {{ElementClass::kLaneDivider,
                   Appearance::kSolid,
                   {{99'999'999.0, -99'999'999.0}, {-99'999'999.0, 99'999'999.0}, {0.001, 0.0}}}};
  const auto again = decode_map(encode_map(map), "town.bvm");
  ASSERT_TRUE(again.has_value()) << again.error().message;
  expect_near(again->elements[0].points, map.elements[0].points);
}

TEST(MapBinary, RefusesEveryTruncation) {
  HdMap map = kilometre();
  map.elements[0].points.resize(20);
  map.elements.erase(map.elements.begin() + 1, map.elements.begin() + 3);
  map.lanes.clear();
  const std::string bytes = encode_map(map);
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_map(bytes.substr(0, size), "town.bvm").has_value()) << size;
  }
  EXPECT_THAT(decode_error(bytes + "x"), HasSubstr("as its header states"));
}

TEST(MapBinary, RefusesEveryFlippedByte) {
  HdMap map = kilometre();
  map.elements.resize(1);
  map.elements[0].points.resize(20);
  map.lanes.resize(1);
  map.lanes[0].successors = {0};
  for (auto* line : {&map.lanes[0].left, &map.lanes[0].right, &map.lanes[0].centerline}) {
    line->resize(10);
  }
  std::string bytes = encode_map(map);
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (const char flip : {'\x01', '\x80', '\xFF'}) {
      bytes[i] ^= flip;
      EXPECT_FALSE(decode_map(bytes, "town.bvm").has_value()) << i;
      bytes[i] ^= flip;
    }
  }
}

TEST(MapBinary, ErrorsNameTheCause) {
  const std::string bytes = encode_map(kilometre());
  EXPECT_EQ(decode_error("BVMP"), "town.bvm: found 4 bytes, wanted a map file of at least 14");
  EXPECT_THAT(decode_error("PK" + bytes), HasSubstr("wanted \"BVMP\""));
  std::string newer = bytes;
  newer[4] = 9;
  EXPECT_EQ(decode_error(newer), "town.bvm: found version 9 of the format, wanted 1 or 2");
  std::string damaged = bytes;
  damaged[60] ^= 1;
  EXPECT_THAT(decode_error(damaged), StartsWith("town.bvm: found CRC-32 "));
}

TEST(MapBinary, RefusesAnInvalidBodyWithAValidChecksum) {
  const std::string head = std::string(1, '\0') + std::string(16, '\0');  // no name, origin (0, 0)
  EXPECT_TRUE(decode_map(framed_map(head + std::string(2, '\0')), "t").has_value());
  EXPECT_THAT(decode_error(framed_map("")), HasSubstr("the end of the body"));
  EXPECT_THAT(decode_error(framed_map("\x05"
                                      "ab")),
              HasSubstr("a count that exceeds the body"));
  EXPECT_THAT(decode_error(framed_map(head + std::string(3, '\0'))), HasSubstr("more bytes after"));
  EXPECT_THAT(decode_error(framed_map(head + std::string("\xFF\xFF\xFF\xFF\x7F", 5))),
              HasSubstr("a count that exceeds the body"));
  EXPECT_THAT(decode_error(framed_map(std::string(11, '\xFF'))), HasSubstr("more than 64 bits"));
  EXPECT_THAT(decode_error(framed_map(head + std::string("\x01\x03\x00\x00\x00", 5))),
              HasSubstr("an unknown class"));
  EXPECT_THAT(decode_error(framed_map(head + std::string("\x01\x00\x63\x00\x00", 5))),
              HasSubstr("an unknown appearance"));
  const std::string far = std::string(9, '\xFF') + '\x01';
  EXPECT_THAT(
      decode_error(framed_map(head + std::string("\x01\x00\x00\x01", 4) + far + far + '\0')),
      HasSubstr("a point beyond"));
  const std::string lane = std::string("\x00\x01\x00\x00\x00", 5) + std::string(8, '\0');
  EXPECT_THAT(decode_error(framed_map(head + lane + "\x01\x07")), HasSubstr("a successor"));
  const std::string nan_latitude = '\0' + std::string(8, '\xFF') + std::string(10, '\0');
  EXPECT_THAT(decode_error(framed_map(nan_latitude)), HasSubstr("a latitude"));
}

TEST(MapBinary, SurvivesRandomBodies) {
  sim::Random random(11);
  for (int i = 0; i < 20'000; ++i) {
    std::string body(static_cast<size_t>(random.integer(0, 60)), '\0');
    for (char& byte : body) byte = static_cast<char>(random.integer(0, 3) * random.integer(0, 85));
    const auto map = decode_map(framed_map(body), "town.bvm");
    if (!map) {
      EXPECT_THAT(map.error().message, StartsWith("town.bvm: byte "));
    }
  }
}

class MapFiles : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
};

TEST_F(MapFiles, LoadMapRecognisesTheFormats) {
  const auto binary = folder_ / "town.map";
  ASSERT_TRUE(write_map_binary(kilometre(), binary).has_value());
  const HdMap map = load_map(binary).value();
  EXPECT_EQ(map.name, "kilometre");
  EXPECT_EQ(map.lanes.size(), 2U);
  const auto osm =
      std::filesystem::path(BEVLOC_SOURCE_DIR) / "tests/pipeline/map/fixtures/street.osm";
  EXPECT_EQ(load_map(osm).value().lanes.size(), 4U);
}

TEST_F(MapFiles, LoadMapRefusesMapsWithoutLines) {
  const auto binary = folder_ / "empty.bvm";
  HdMap map;
  ASSERT_TRUE(write_map_binary(map, binary).has_value());
  EXPECT_THAT(load_map(binary).error().message,
              HasSubstr("empty.bvm: found 0 lanes and no line of a divider, crossing or boundary"));
  map = kilometre();
  for (MapElement& element : map.elements) element.points.resize(1);
  ASSERT_TRUE(write_map_binary(map, binary).has_value());
  EXPECT_THAT(load_map(binary).error().message, HasSubstr("found 2 lanes and no line"));
}

TEST_F(MapFiles, LoadMapRefusesFarAndLongLines) {
  const auto binary = folder_ / "far.bvm";
  HdMap map = kilometre();
  map.elements[1].points[7].x() = 1e7;
  ASSERT_TRUE(write_map_binary(map, binary).has_value());
  EXPECT_THAT(load_map(binary).error().message,
              HasSubstr("far.bvm: element 1: found a point (1e+07"));
  map = kilometre();
  map.lanes[1].centerline = {{0, 0}, {30'000, 0}, {0, 0}};
  ASSERT_TRUE(write_map_binary(map, binary).has_value());
  EXPECT_THAT(load_map(binary).error().message,
              HasSubstr("far.bvm: lane 1: found a line of 60000 m, wanted at most 50000 m"));
}

TEST_F(MapFiles, LoadMapRefusesOtherFiles) {
  const auto missing = load_map(folder_ / "none.bvm");
  ASSERT_FALSE(missing.has_value());
  EXPECT_THAT(missing.error().message, HasSubstr("none.bvm: found no readable file"));
  const auto other = load_map(std::filesystem::path(BEVLOC_SOURCE_DIR) / "CMakeLists.txt");
  ASSERT_FALSE(other.has_value());
  EXPECT_THAT(
      other.error().message,
      HasSubstr("no map format begins with, wanted one of compact (.bvm), Lanelet2 (.osm)"));
}

}  // namespace
}  // namespace bevloc
