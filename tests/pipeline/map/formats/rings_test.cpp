// Crossings and other closed lines of all formats.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/geojson.h"
#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_checksum.h"
#include "tests/pipeline/map/formats/imported_map.h"

namespace bevloc {
namespace {

using test::of;
using testing::Contains;
using testing::HasSubstr;

ImportedMap map_of(std::string_view text, const std::string& file, const std::string& rules = "") {
  ImportOptions options;
  ClassTable table;
  if (!rules.empty()) {
    table = ClassTable::parse("rules:\n" + rules, "classes.yaml").value();
    options.classes = &table;
  }
  return test::imported(text, file, options);
}

std::vector<std::string> reasons_of(const ImportedMap& map) {
  std::vector<std::string> reasons;
  for (const ImportRow& row : map.report.rows()) {
    if (!row.meaning) reasons.push_back(row.kind + ": " + row.why);
  }
  return reasons;
}

TEST(Rings, SplitSidesBecomeOneEdge) {
  // 12 m x 4 m with a vertex every 2 m on the long sides, from the middle of one of them.
  Polyline ring;
  for (double x = 6.0; x < 12.0; x += 2.0) ring.emplace_back(x, 0.01 * x);
  for (double x = 12.0; x >= 0.0; x -= 2.0) ring.emplace_back(x, x == 12.0 ? 0.0 : 4.0);
  ring.insert(ring.begin() + 4, Eigen::Vector2d(12.0, 4.0));
  for (double x = 0.0; x < 6.0; x += 2.0) ring.emplace_back(x, 0.0);
  Polyline corners;
  for (const size_t i : corners_of_ring(ring)) corners.push_back(ring[i]);
  EXPECT_EQ(corners, (Polyline{{12, 0}, {12, 4}, {0, 4}, {0, 0}}));
  EXPECT_EQ(corners_of_ring(corners).size(), 4U) << "a second time changes nothing";
  const Polyline thin{{0, 0}, {5, 0.1}, {9, 0}, {9, 0.2}, {0, 0.2}};
  EXPECT_EQ(corners_of_ring(thin).size(), 5U) << "a ring stays a ring";
}

TEST(Rings, ACrossingOfGeojsonHasItsCornersOnly) {
  ImportedMap map;
  map.map.origin = {49.0, 8.4};
  MapElement crossing{ElementClass::kPedestrianCrossing, Appearance::kUnknown, {}};
  for (double x = -6.0; x <= 6.0; x += 2.0) crossing.points.emplace_back(x, -2.0);
  for (double x = 6.0; x >= -6.0; x -= 2.0) crossing.points.emplace_back(x, 2.0);
  map.map.elements = {crossing};
  const ImportedMap first = map_of(to_geojson(map).value(), "crossing.geojson");
  ASSERT_EQ(first.map.elements.size(), 1U);
  const Polyline& corners = first.map.elements[0].points;
  ASSERT_EQ(corners.size(), 4U);
  EXPECT_LT((corners[0] - Eigen::Vector2d(-6, -2)).norm(), 0.001);
  EXPECT_LT((corners[2] - Eigen::Vector2d(6, 2)).norm(), 0.001);
  const ImportedMap again = map_of(to_geojson(first).value(), "crossing.geojson");
  EXPECT_EQ(map_checksum(again.map), map_checksum(first.map));
}

/// A road of 100 m with these objects.
std::string road_with(std::string_view objects) {
  return fmt::format(R"(<OpenDRIVE><header revMajor="1"/><road id="7" length="100" junction="-1">
<planView><geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0"><roadMark sOffset="0" type="broken"/></lane></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right>
</laneSection></lanes><objects>{}</objects></road></OpenDRIVE>)",
                     objects);
}

TEST(Rings, ARingThatBecomesALineKeepsItsClosingSide) {
  constexpr std::string_view kIsland = R"(<object id="1" type="trafficIsland" s="50" t="-2">
    <outlines><outline{}><cornerLocal u="1" v="1"/><cornerLocal u="-1" v="1"/>
    <cornerLocal u="-1" v="-1"/><cornerLocal u="1" v="-1"/></outline></outlines></object>)";
  const std::string rules =
      "  - kind: object trafficIsland\n    becomes: boundary\n    appearance: barrier\n";
  const auto length_with = [&](std::string_view attribute) {
    const ImportedMap map =
        map_of(road_with(fmt::format(fmt::runtime(kIsland), attribute)), "road.xodr", rules);
    for (const MapElement& element : map.map.elements) {
      if (element.appearance == Appearance::kBarrier) return length_of(element);
    }
    return 0.0;
  };
  EXPECT_NEAR(length_with(""), 8.0, 1e-6);
  EXPECT_NEAR(length_with(" closed=\"false\""), 6.0, 1e-6) << "a line, not an area";
}

TEST(Rings, TheFirstOutlineMayBeAHole) {
  const ImportedMap map = map_of(road_with(R"(<object id="1" type="crosswalk" s="50" t="0">
    <outlines><outline outer="false"><cornerLocal u="1" v="1"/><cornerLocal u="-1" v="1"/>
    <cornerLocal u="-1" v="-1"/></outline><outline><cornerLocal u="3" v="2"/>
    <cornerLocal u="-3" v="2"/><cornerLocal u="-3" v="-2"/><cornerLocal u="3" v="-2"/></outline>
    </outlines></object>)"),
                                 "road.xodr");
  const auto crossings = of(map, ElementClass::kPedestrianCrossing);
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_NEAR(area_of_ring_m2(crossings[0].points), 24.0, 1e-6);
}

TEST(Rings, TheNameOfAnObjectCountsOnlyWithoutAType) {
  const auto crossings_with = [](std::string_view type) {
    return of(map_of(road_with(fmt::format(R"(<object id="1" {} name="CrosswalkSign" s="50" t="0"
        length="3" width="4"/>)",
                                           type)),
                     "road.xodr"),
              ElementClass::kPedestrianCrossing)
        .size();
  };
  EXPECT_EQ(crossings_with("type=\"pole\""), 0U);
  for (const char* type : {"", "type=\"\"", "type=\"none\"", "type=\"-1\"", "type=\"crosswalk\""}) {
    EXPECT_EQ(crossings_with(type), 1U) << type;
  }
}

/// Ways of a square of 10 m and a kerb, so that the map is never empty.
constexpr std::string_view kWays = R"(<osm>
 <node id="1"><tag k="local_x" v="0"/><tag k="local_y" v="0"/></node>
 <node id="2"><tag k="local_x" v="10"/><tag k="local_y" v="0"/></node>
 <node id="3"><tag k="local_x" v="10"/><tag k="local_y" v="10"/></node>
 <node id="4"><tag k="local_x" v="0"/><tag k="local_y" v="10"/></node>
 <way id="10"><nd ref="1"/><nd ref="2"/><tag k="type" v="curbstone"/></way>
 <way id="11"><nd ref="1"/><nd ref="2"/><tag k="type" v="zebra"/></way>
 <way id="12"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
  <tag k="type" v="zebra"/></way>
 <way id="13"><nd ref="1"/><nd ref="2"/><tag k="type" v="virtual"/></way>
 <way id="14"><nd ref="4"/><nd ref="3"/><tag k="type" v="virtual"/></way>
 <relation id="21"><member type="way" role="left" ref="13"/>
  <member type="way" role="right" ref="14"/><tag k="type" v="lanelet"/>
  <tag k="subtype" v="crosswalk"/></relation></osm>)";

TEST(Rings, OfLanelet2HaveTheShapeOfTheirClass) {
  const ImportedMap map = map_of(kWays, "ways.osm",
                                 "  - kind: way zebra\n    becomes: crossing\n"
                                 "  - kind: lanelet crosswalk\n    becomes: boundary\n");
  const auto crossings = of(map, ElementClass::kPedestrianCrossing);
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_EQ(crossings[0].points.size(), 4U) << "without the repeated corner";
  EXPECT_THAT(reasons_of(map), Contains("way zebra: too few points"));
  const auto boundaries = of(map, ElementClass::kRoadBoundary);
  ASSERT_EQ(boundaries.size(), 2U);
  EXPECT_EQ(boundaries[0].points.front(), boundaries[0].points.back()) << "with the closing side";
}

TEST(Rings, OfNuscenesCloseAndTheirHolesAreReported) {
  constexpr std::string_view kCrossing = R"({
 "node": [{"token": "a", "x": 0, "y": 0}, {"token": "b", "x": 40, "y": 0},
  {"token": "c", "x": 40, "y": 10}, {"token": "d", "x": 0, "y": 10}],
 "line": [], "drivable_area": [],
 "polygon": [{"token": "p1", "exterior_node_tokens": ["a", "b", "c", "d"],
   "holes": [{"node_tokens": ["a", "b", "c"]}]}],
 "ped_crossing": [{"token": "pc", "polygon_token": "p1"}]})";
  const ImportedMap plain = map_of(kCrossing, "map.json");
  EXPECT_EQ(plain.map.elements.at(0).points.size(), 4U);
  EXPECT_THAT(reasons_of(plain), Contains("ped_crossing: a hole in a crossing"));
  const ImportedMap line =
      map_of(kCrossing, "map.json", "  - kind: ped_crossing\n    becomes: boundary\n");
  EXPECT_DOUBLE_EQ(length_of(line.map.elements.at(0)), 100.0);
}

/// Two lanelets that share a line. The right bound of the first has no type, and `more` holds the
/// ways beside it.
std::string lanelet_beside(std::string_view more) {
  return fmt::format(R"(<osm>
 <node id="1"><tag k="local_x" v="0"/><tag k="local_y" v="0"/></node>
 <node id="2"><tag k="local_x" v="50"/><tag k="local_y" v="0"/></node>
 <node id="3"><tag k="local_x" v="0"/><tag k="local_y" v="4"/></node>
 <node id="4"><tag k="local_x" v="50"/><tag k="local_y" v="4"/></node>
 <node id="5"><tag k="local_x" v="0"/><tag k="local_y" v="-0.3"/></node>
 <node id="6"><tag k="local_x" v="50"/><tag k="local_y" v="-0.3"/></node>
 <node id="7"><tag k="local_x" v="0"/><tag k="local_y" v="-4"/></node>
 <node id="8"><tag k="local_x" v="50"/><tag k="local_y" v="-4"/></node>
 <way id="11"><nd ref="1"/><nd ref="2"/></way>
 <way id="12"><nd ref="3"/><nd ref="4"/><tag k="type" v="road_border"/></way>
 <relation id="21"><member type="way" role="left" ref="12"/>
  <member type="way" role="right" ref="11"/><tag k="type" v="lanelet"/></relation>{}</osm>)",
                     more);
}

TEST(BoundNeighbours, AnUntypedBoundBesideAKerbIsTheKerb) {
  const ImportedMap kerb =
      map_of(lanelet_beside(
                 R"(<way id="13"><nd ref="5"/><nd ref="6"/><tag k="type" v="curbstone"/></way>)"),
             "kerb.osm");
  EXPECT_TRUE(of(kerb, ElementClass::kLaneDivider).empty());
  EXPECT_EQ(of(kerb, ElementClass::kRoadBoundary).size(), 2U);
  EXPECT_THAT(reasons_of(kerb), Contains("way without type: a road boundary is the same line"));

  const ImportedMap bound = map_of(lanelet_beside(R"(<way id="13"><nd ref="5"/><nd ref="6"/></way>
 <way id="14"><nd ref="7"/><nd ref="8"/><tag k="type" v="road_border"/></way>
 <relation id="22"><member type="way" role="left" ref="13"/>
  <member type="way" role="right" ref="14"/><tag k="type" v="lanelet"/></relation>)"),
                                   "bound.osm");
  EXPECT_EQ(of(bound, ElementClass::kLaneDivider).size(), 1U) << "once, between the lanelets";

  // The second lanelet lacks its right bound and is left out.
  const ImportedMap lost = map_of(lanelet_beside(R"(<way id="13"><nd ref="7"/><nd ref="8"/></way>
 <relation id="22"><member type="way" role="left" ref="13"/><tag k="type" v="lanelet"/></relation>)"),
                                  "lost.osm");
  EXPECT_TRUE(of(lost, ElementClass::kLaneDivider).empty()) << "a way is no neighbour of itself";
}

}  // namespace
}  // namespace bevloc
