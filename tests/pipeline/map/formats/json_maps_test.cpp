// Argoverse 2, nuScenes and GeoJSON.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/geojson.h"
#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_loader.h"
#include "tests/pipeline/map/formats/imported_map.h"
#include "tests/support/text.h"

namespace bevloc {
namespace {

using test::replaced;
using testing::HasSubstr;

/// Two lanes side by side from west to east, a third that follows the first one, a crossing, and
/// two areas that meet at x = 50.
constexpr std::string_view kArgoverse = R"({
 "lane_segments": {
  "1": {"id": 1, "lane_type": "VEHICLE", "successors": [3], "predecessors": [],
   "left_lane_boundary": [{"x": 0, "y": 4, "z": 1}, {"x": 50, "y": 4, "z": 1}],
   "right_lane_boundary": [{"x": 0, "y": 0, "z": 1}, {"x": 50, "y": 0, "z": 1}],
   "left_lane_mark_type": "DASHED_WHITE", "right_lane_mark_type": "NONE"},
  "2": {"id": 2, "lane_type": "BIKE", "successors": [],
   "left_lane_boundary": [{"x": 50, "y": 4, "z": 1}, {"x": 0, "y": 4, "z": 1}],
   "right_lane_boundary": [{"x": 50, "y": 8, "z": 1}, {"x": 0, "y": 8, "z": 1}],
   "left_lane_mark_type": "DASHED_WHITE", "right_lane_mark_type": "DOUBLE_SOLID_YELLOW"},
  "3": {"id": 3, "lane_type": "VEHICLE", "successors": [99],
   "left_lane_boundary": [{"x": 50, "y": 4, "z": 1}, {"x": 90, "y": 4, "z": 2}],
   "right_lane_boundary": [{"x": 50, "y": 0, "z": 1}, {"x": 90, "y": 0, "z": 2}],
   "left_lane_mark_type": "NONE", "right_lane_mark_type": "NONE"}},
 "pedestrian_crossings": {"7": {"id": 7,
   "edge1": [{"x": 20, "y": 0, "z": 1}, {"x": 20, "y": 8, "z": 1}],
   "edge2": [{"x": 23, "y": 0, "z": 1}, {"x": 23, "y": 8, "z": 1}]}},
 "drivable_areas": {
  "8": {"id": 8, "area_boundary": [{"x": -5, "y": -1, "z": 1}, {"x": 50, "y": -1, "z": 1},
    {"x": 50, "y": 9, "z": 1}, {"x": -5, "y": 9, "z": 1}]},
  "9": {"id": 9, "area_boundary": [{"x": 50, "y": 9, "z": 1}, {"x": 50, "y": -1, "z": 1},
    {"x": 95, "y": -1, "z": 2}, {"x": 95, "y": 9, "z": 2}]}}
})";

std::string json_error(std::string_view text, const std::string& file = "map.json") {
  return test::import_error(text, file);
}

long count_of(const HdMap& map, ElementClass element_class) {
  return std::ranges::count(map.elements, element_class, &MapElement::element_class);
}

TEST(Argoverse2, ACrossingNeedsNoHeight) {
  std::string flat(kArgoverse);
  const std::string height = ", \"z\": 1";
  const size_t begin = flat.find("pedestrian_crossings");
  const size_t end = flat.find("drivable_areas");
  for (size_t at = flat.find(height, begin); at < end; at = flat.find(height, at)) {
    flat.erase(at, height.size());
  }
  const auto imported = parse_imported(flat, "map.json", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  ASSERT_EQ(count_of(imported->map, ElementClass::kPedestrianCrossing), 1);
}

TEST(Argoverse2, TakesEachMarkOnceAndTheOutlineOfAllAreas) {
  const auto imported = parse_imported(kArgoverse, "map.json", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  const HdMap& map = imported->map;
  EXPECT_EQ(count_of(map, ElementClass::kLaneDivider), 2) << "lanes 1 and 2 share a line";
  EXPECT_EQ(count_of(map, ElementClass::kPedestrianCrossing), 1);
  for (const MapElement& element : map.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    for (size_t i = 0; i + 1 < element.points.size(); ++i) {
      const Eigen::Vector2d middle = 0.5 * (element.points[i] + element.points[i + 1]);
      EXPECT_TRUE(std::abs(middle.x() - 50.0) > 0.3 || middle.y() < -0.9 || middle.y() > 8.9)
          << "the areas meet at " << middle.transpose();
    }
  }
  ASSERT_EQ(map.lanes.size(), 2U) << "the bicycle lane is none for vehicles";
  EXPECT_EQ(map.lanes[0].successors, std::vector<uint32_t>{1});
  EXPECT_TRUE(map.lanes[1].successors.empty()) << "lane 99 is not in the file";
}

TEST(Argoverse2, EdgesBesideATaperingLaneStayAndNoneCrossesALane) {
  // Two lanes of 3.5 m; the right one tapers away from x = 40 to x = 100.
  constexpr std::string_view kTaper = R"({
 "lane_segments": {
  "1": {"id": 1, "lane_type": "VEHICLE", "successors": [],
   "left_lane_boundary": [{"x": 0, "y": 3.5}, {"x": 40, "y": 3.5}, {"x": 100, "y": 0}],
   "right_lane_boundary": [{"x": 0, "y": 0}, {"x": 100, "y": 0}],
   "left_lane_mark_type": "NONE", "right_lane_mark_type": "NONE"},
  "2": {"id": 2, "lane_type": "VEHICLE", "successors": [],
   "left_lane_boundary": [{"x": 0, "y": 7}, {"x": 100, "y": 7}],
   "right_lane_boundary": [{"x": 0, "y": 3.5}, {"x": 40, "y": 3.5}, {"x": 100, "y": 0}],
   "left_lane_mark_type": "NONE", "right_lane_mark_type": "NONE"}},
 "pedestrian_crossings": {},
 "drivable_areas": {"8": {"id": 8, "area_boundary": [{"x": 0, "y": 0}, {"x": 100, "y": 0},
   {"x": 100, "y": 7}, {"x": 0, "y": 7}]}}})";
  const auto imported = parse_imported(kTaper, "map.json", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  ASSERT_EQ(count_of(imported->map, ElementClass::kRoadBoundary), 2);
  for (const MapElement& edge : imported->map.elements) {
    EXPECT_NEAR((edge.points.back() - edge.points.front()).norm(), 100.0, 1e-9);
    EXPECT_EQ(edge.points.back().y(), edge.points.front().y());
  }
}

TEST(Argoverse2, TheNameOfTheFileGivesTheCity) {
  EXPECT_EQ(parse_imported(kArgoverse, "log_map.json", {})->map.origin.latitude_deg, 0.0);
  const auto imported = parse_imported(kArgoverse, "log_map_archive_x____PIT_city_47896.json", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  EXPECT_NEAR(imported->map.origin.latitude_deg, 40.4418, 1e-3);
  EXPECT_NEAR(imported->map.origin.longitude_deg, -80.0125, 1e-3);
}

TEST(Argoverse2, TakesEveryPaintedMark) {
  // All values of LaneMarkType in the data set's API.
  for (const std::string mark :
       {"DASH_SOLID_YELLOW", "DASH_SOLID_WHITE", "DASHED_WHITE", "DASHED_YELLOW",
        "DOUBLE_SOLID_YELLOW", "DOUBLE_SOLID_WHITE", "DOUBLE_DASH_YELLOW", "DOUBLE_DASH_WHITE",
        "SOLID_YELLOW", "SOLID_WHITE", "SOLID_DASH_WHITE", "SOLID_DASH_YELLOW", "SOLID_BLUE"}) {
    const auto imported =
        parse_imported(replaced(kArgoverse, "DOUBLE_SOLID_YELLOW", mark), "map.json", {});
    ASSERT_TRUE(imported.has_value()) << imported.error().message;
    EXPECT_TRUE(std::ranges::any_of(imported->report.rows(), [&](const ImportRow& row) {
      return row.kind == "lane mark " + mark && row.meaning.has_value();
    })) << mark;
  }
}

TEST(Argoverse2, RefusesBrokenFilesWithLineAndPath) {
  EXPECT_THAT(json_error(kArgoverse.substr(0, 900)),
              HasSubstr("map.json:14: byte 900: found text that is not JSON (syntax error while"));
  EXPECT_EQ(
      json_error(replaced(kArgoverse, R"({"x": 50, "y": 4, "z": 1}],)",
                          R"({"x": "no", "y": 4, "z": 1}],)")),
      "map.json:4: /lane_segments/1/left_lane_boundary/1: found x = \"no\", wanted a number of "
      "metres");
  EXPECT_THAT(json_error(replaced(kArgoverse, R"("edge2")", R"("edge3")")),
              HasSubstr("/pedestrian_crossings/7/edge2: found 0 points"));
  EXPECT_THAT(json_error(std::string(100, '[') + "\"lane_segments\""), HasSubstr("wanted one of"));
  EXPECT_THAT(json_error("{\"lane_segments\":" + std::string(100, '[')),
              HasSubstr("brackets within each other"));
}

constexpr std::string_view kNuscenes = R"({"version": "1.3",
 "node": [{"token": "a", "x": 0, "y": 0}, {"token": "b", "x": 40, "y": 0},
  {"token": "c", "x": 40, "y": 10}, {"token": "d", "x": 0, "y": 10},
  {"token": "e", "x": 0, "y": 5}, {"token": "f", "x": 20, "y": 5}, {"token": "g", "x": 40, "y": 5}],
 "line": [{"token": "l1", "node_tokens": ["e", "f", "g"]}],
 "polygon": [{"token": "p1", "exterior_node_tokens": ["a", "b", "c", "d"], "holes": []}],
 "drivable_area": [{"token": "da", "polygon_tokens": ["p1"]}],
 "lane_divider": [{"token": "ld", "line_token": "l1", "lane_divider_segments": [
   {"node_token": "e", "segment_type": "DOUBLE_DASHED_WHITE"},
   {"node_token": "f", "segment_type": "NIL"}, {"node_token": "g", "segment_type": "NIL"}]}],
 "road_divider": [], "ped_crossing": [{"token": "pc", "polygon_token": "p1"}],
 "connectivity": {"la": {"incoming": [], "outgoing": ["lb"]}},
 "arcline_path_3": {
  "la": [{"start_pose": [0, 2.5, 0], "end_pose": [20, 2.5, 0], "shape": "LSR", "radius": 999,
    "segment_length": [0, 20, 0]}],
  "lb": [{"start_pose": [20, 2.5, 0], "end_pose": [30, 12.5, 1.57], "shape": "LSR", "radius": 10,
    "segment_length": [15.707963, 0, 0]}]}})";

TEST(Nuscenes, CutsDividersByTypeAndFollowsTheCurves) {
  const auto imported = parse_imported(kNuscenes, "boston-seaport.json", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  const HdMap& map = imported->map;
  EXPECT_NEAR(map.origin.latitude_deg, 42.3368, 1e-3);
  ASSERT_EQ(count_of(map, ElementClass::kLaneDivider), 1) << "the second half is not painted";
  for (const MapElement& element : map.elements) {
    if (element.element_class != ElementClass::kLaneDivider) continue;
    EXPECT_EQ(element.appearance, Appearance::kDashed);
    EXPECT_NEAR((element.points.back() - element.points.front()).norm(), 20.0, 1e-3);
  }
  EXPECT_EQ(count_of(map, ElementClass::kPedestrianCrossing), 1);
  EXPECT_EQ(count_of(map, ElementClass::kRoadBoundary), 1) << "one closed outline";
  ASSERT_EQ(map.lanes.size(), 2U);
  EXPECT_EQ(map.lanes[0].successors, std::vector<uint32_t>{1});
  const auto& curve = map.lanes[1].centerline;
  EXPECT_NEAR((curve.back() - curve.front()).norm(), 10.0 * std::sqrt(2.0), 0.02)
      << "a quarter of a circle";
}

TEST(Nuscenes, RefusesReferencesToNothing) {
  EXPECT_THAT(json_error(replaced(kNuscenes, R"(["e", "f", "g"])", R"(["e", "x", "g"])")),
              HasSubstr("map.json:5: /line/0/node_tokens/1: found a reference to node \"x\""));
  EXPECT_THAT(json_error(replaced(kNuscenes, R"("line_token": "l1")", R"("line_token": "l2")")),
              HasSubstr("/lane_divider/0: found a line_token that refers to a missing record"));
  EXPECT_THAT(json_error(replaced(kNuscenes, R"("radius": 10)", R"("radius": "10")")),
              HasSubstr("/arcline_path_3/lb/0: found no start_pose"));
}

ImportedMap small_map() {
  ImportedMap imported;
  imported.map.name = "small";
  imported.map.origin = {49.0, 8.4};
  imported.map.elements = {
      {ElementClass::kRoadBoundary, Appearance::kKerb, {{-40, 4}, {0, 4.5}, {40, 4}}},
      {ElementClass::kLaneDivider, Appearance::kDashed, {{-40, 0}, {40, 0}}},
      {ElementClass::kPedestrianCrossing,
       Appearance::kZebra,
       {{9, -4}, {12, -4}, {12, 4}, {9, 4}}}};
  imported.map.lanes = {{{{-40, 4}, {0, 4}}, {{-40, 0}, {0, 0}}, {{-40, 2}, {0, 2}}, {1}, 8.5},
                        {{{0, 4}, {40, 4}}, {{0, 0}, {40, 0}}, {{0, 2}, {40, 2}}, {}, 13.9}};
  imported.heights_m = {{1.0, 2.0, 3.5}, {}, {}};
  return imported;
}

TEST(Geojson, ARoundTripKeepsTheMap) {
  const ImportedMap first = small_map();
  const auto text = to_geojson(first);
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const auto again = parse_imported(*text, "small.geojson", {});
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->map.name, "small");
  EXPECT_EQ(map_checksum(again->map), map_checksum(first.map));
  for (size_t i = 0; i < first.map.elements.size(); ++i) {
    EXPECT_EQ(again->map.elements[i].appearance, first.map.elements[i].appearance);
  }
  EXPECT_EQ(again->heights_m[0], first.heights_m[0]);
  EXPECT_TRUE(again->heights_m[1].empty());
  ASSERT_EQ(again->map.lanes.size(), 2U);
  EXPECT_EQ(again->map.lanes[0].successors, std::vector<uint32_t>{1});
  EXPECT_EQ(again->map.lanes[0].speed_limit_mps, 8.5);
}

TEST(Geojson, ReadsForeignFeaturesWithAClassTable) {
  constexpr std::string_view kForeign = R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"type": "kerbstone"}, "geometry": {"type": "MultiLineString",
     "coordinates": [[[8.4, 49.0], [8.401, 49.0]], [[8.4, 49.001], [8.401, 49.001]]]}},
    {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [8, 49]}}]})";
  EXPECT_THAT(json_error(kForeign), HasSubstr("found 0 lanes and no line"));
  const auto table = ClassTable::parse(
      "rules:\n  - kind: kerbstone\n    becomes: boundary\n    appearance: kerb\n", "t.yaml");
  ImportOptions options;
  options.classes = &*table;
  const auto imported = parse_imported(kForeign, "f.geojson", options);
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  ASSERT_EQ(imported->map.elements.size(), 2U);
  const auto& points = imported->map.elements[0].points;
  EXPECT_NEAR((points[1] - points[0]).norm(), 73.2, 0.1) << "0.001 degrees at latitude 49";
}

TEST(Geojson, AForeignLaneIsAKindLikeAnyOther) {
  constexpr std::string_view kLane = R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"class": "divider"}, "geometry": {"type": "LineString",
     "coordinates": [[8.4, 49.0], [8.401, 49.0]]}},
    {"type": "Feature", "properties": {"type": "lane", "left": 12}, "geometry": {"type":
     "LineString", "coordinates": [[8.4, 49.001], [8.401, 49.001]]}}]})";
  const auto imported = parse_imported(kLane, "f.geojson", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  EXPECT_EQ(imported->map.elements.size(), 1U);
  EXPECT_TRUE(imported->map.lanes.empty());
  const auto rows = imported->report.rows();
  const auto dropped = std::ranges::find(rows, "lane", &ImportRow::kind);
  ASSERT_NE(dropped, rows.end());
  EXPECT_EQ(dropped->why, "no class of bevloc");

  const auto table = ClassTable::parse("rules:\n  - kind: lane\n    becomes: divider\n", "t.yaml");
  ImportOptions options;
  options.classes = &*table;
  const auto ruled = parse_imported(kLane, "f.geojson", options);
  ASSERT_TRUE(ruled.has_value()) << ruled.error().message;
  EXPECT_EQ(ruled->map.elements.size(), 2U);
}

TEST(Geojson, ReadsCollectionsAndLeavesOutTheHolesOfCrossings) {
  constexpr std::string_view kCollection = R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"class": "boundary"}, "geometry":
     {"type": "GeometryCollection", "geometries": [
      {"type": "Point", "coordinates": [8.4, 49.0]},
      {"type": "LineString", "coordinates": [[8.4, 49.0], [8.401, 49.0]]}]}},
    {"type": "Feature", "properties": {"class": "crossing"}, "geometry": {"type": "Polygon",
     "coordinates": [
      [[8.4005, 49.0], [8.4006, 49.0], [8.4006, 49.0001], [8.4005, 49.0001], [8.4005, 49.0]],
      [[8.40053, 49.00003], [8.40056, 49.00003], [8.40056, 49.00006], [8.40053, 49.00003]]]}}]})";
  const auto imported = parse_imported(kCollection, "f.geojson", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  ASSERT_EQ(imported->map.elements.size(), 2U);
  EXPECT_NEAR(length_of(imported->map.elements[0]), 73.2, 0.1);
  const auto rows = imported->report.rows();
  const auto hole = std::ranges::find(rows, "a hole in a crossing", &ImportRow::why);
  ASSERT_NE(hole, rows.end());
  EXPECT_EQ(hole->kind, "crossing");
  const auto crossing = std::ranges::find_if(
      rows, [](const ImportRow& row) { return row.kind == "crossing" && row.meaning; });
  ASSERT_NE(crossing, rows.end());
  EXPECT_NEAR(crossing->length_m, 2 * (7.32 + 11.12), 0.1) << "with the closing edge";
}

TEST(Geojson, RefusesWhatIsNotOnEarth) {
  constexpr std::string_view kFar = R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"class": "divider"}, "geometry": {"type": "LineString",
     "coordinates": [[8.4, 49.0],
      [458000, 5428000]]}}]})";
  EXPECT_EQ(json_error(kFar),
            "map.json:4: /features/0/geometry/coordinates/1: found [458000,5428000], wanted "
            "longitude and latitude in degrees");
  ImportedMap nowhere = small_map();
  nowhere.map.origin = {};
  EXPECT_FALSE(to_geojson(nowhere).has_value());
}

}  // namespace
}  // namespace bevloc
