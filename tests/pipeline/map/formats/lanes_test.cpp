// Lanes that no vehicle can drive along, and their successors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/lanelet_tags.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/tiles/tile_codec.h"

namespace bevloc {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::string_view kDivider =
    R"({"type": "Feature", "properties": {"class": "divider"}, "geometry": {"type": "LineString",
        "coordinates": [[8.4, 49], [8.41, 49]]}})";

/// A lane from one longitude to another, as a feature of GeoJSON.
std::string lane(double from_deg, double to_deg, std::string_view successors = "") {
  const auto line = [&](double latitude_deg) {
    return fmt::format("[[{}, {}], [{}, {}]]", from_deg, latitude_deg, to_deg, latitude_deg);
  };
  return fmt::format(R"(, {{"type": "Feature", "properties": {{"class": "lane", "left": {},
    "right": {}{}}}, "geometry": {{"type": "LineString", "coordinates": {}}}}})",
                     line(49.00004), line(49.0),
                     successors.empty() ? "" : fmt::format(", \"successors\": {}", successors),
                     line(49.00002));
}

ImportedMap with_lanes(const std::string& lanes) {
  auto map = parse_imported(
      fmt::format(R"({{"type": "FeatureCollection", "features": [{}{}]}})", kDivider, lanes),
      "lanes.geojson", {});
  EXPECT_TRUE(map.has_value()) << map.error().message;
  return map.value_or(ImportedMap{});
}

TEST(Lanes, WithoutLengthAreLeftOut) {
  const ImportedMap map =
      with_lanes(lane(8.4, 8.4, "[0]") + lane(8.4, 8.401, "[0, 2]") + lane(8.401, 8.402));
  ASSERT_EQ(map.map.lanes.size(), 2U);
  EXPECT_THAT(map.map.lanes[0].successors, ElementsAre(1));
  EXPECT_THAT(map.map.left_out, Contains(HasSubstr("found 1 lanes that are too short")));
}

TEST(Lanes, OnlyThoseThatStateNoSuccessorsAreLinked) {
  const ImportedMap map = with_lanes(lane(8.4, 8.401, "[1]") + lane(8.401, 8.402) +
                                     lane(8.402, 8.403, "[]") + lane(8.403, 8.404));
  ASSERT_EQ(map.map.lanes.size(), 4U);
  EXPECT_THAT(map.map.lanes[0].successors, ElementsAre(1)) << "not twice";
  EXPECT_THAT(map.map.lanes[1].successors, ElementsAre(2));
  EXPECT_THAT(map.map.lanes[2].successors, IsEmpty()) << "the file says so";
}

TEST(Lanes, ASuccessorBeyond32BitsIsNone) {
  const ImportedMap map = with_lanes(lane(8.4, 8.401, "[4294967296, 4294967297]"));
  EXPECT_THAT(map.map.lanes.at(0).successors, IsEmpty());
}

TEST(Lanes, CompactMapsWithLanesOfNoLengthAreRefused) {
  HdMap map;
  map.elements = {{ElementClass::kLaneDivider, Appearance::kSolid, {{0, 0}, {9, 0}}}};
  const Lane good{{{0, 4}, {9, 4}}, {{0, 0}, {9, 0}}, {{0, 2}, {9, 2}}, {0}, 13.9};
  Lane point = good;
  point.centerline = {{5, 2}, {5, 2}};
  Lane empty = good;
  empty.left.clear();
  for (const Lane& bad : {point, empty}) {
    map.lanes = {bad};
    for (const std::string& bytes : {encode_map(map), encode_tiles(map)}) {
      const auto read = decode_map(bytes, "lanes.bvm");
      ASSERT_FALSE(read.has_value());
      EXPECT_THAT(read.error().message, HasSubstr("found a lane of no length"));
    }
  }
  map.lanes = {good};
  EXPECT_TRUE(decode_map(encode_map(map), "lanes.bvm").has_value());
}

TEST(Lanes, SpeedLimitsMayHaveSpaceAndKph) {
  EXPECT_NEAR(speed_mps(" 36").value(), 10.0, 1e-9);
  EXPECT_NEAR(speed_mps("36 kph ").value(), 10.0, 1e-9);
  EXPECT_NEAR(speed_mps("+10 m/s").value(), 10.0, 1e-9);
  EXPECT_FALSE(speed_mps("fast").has_value());
}

}  // namespace
}  // namespace bevloc
