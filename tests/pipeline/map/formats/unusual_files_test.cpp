// Files that are unusual but not wrong, and files of which a part is wrong.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"
#include "pipeline/map/formats/geojson.h"
#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/tangent_plane.h"
#include "tests/pipeline/map/formats/imported_map.h"

namespace bevloc {
namespace {

using test::imported;
using testing::Contains;
using testing::HasSubstr;

std::string collection(std::string_view members, std::string_view features) {
  return fmt::format(R"({{"type": "FeatureCollection", {}"features": [{}]}})", members, features);
}

std::string divider(std::string_view coordinates) {
  return fmt::format(R"({{"type": "Feature", "properties": {{"class": "lane divider"}},
    "geometry": {{"type": "LineString", "coordinates": {}}}}})",
                     coordinates);
}

/// A street with a lanelet, in which the caller names further nodes, ways and relations.
std::string street(std::string_view more, std::string_view last_latitude = "49.0001",
                   std::string_view height = "110") {
  return fmt::format(R"(<osm>
 <node id="1" lat="49.0" lon="8.4"><tag k="ele" v="110"/></node>
 <node id="2" lat="49.0" lon="8.401"><tag k="ele" v="{2}"/></node>
 <node id="3" lat="49.0001" lon="8.4"><tag k="ele" v="111"/></node>
 <node id="4" lat="{1}" lon="8.401"><tag k="ele" v="112"/></node>
 <way id="11"><nd ref="1"/><nd ref="2"/><tag k="type" v="curbstone"/></way>
 <way id="12"><nd ref="3"/><nd ref="4"/><tag k="type" v="line_thin"/></way>
 <relation id="21"><member type="way" role="left" ref="12"/>
  <member type="way" role="right" ref="11"/><tag k="type" v="lanelet"/></relation>
 {0}</osm>)",
                     more, last_latitude, height);
}

TEST(UnusualGeojson, OnlyLinesAndPolygonsSayWhereTheMapIs) {
  const std::string line = divider("[[13.4, 52.5], [13.402, 52.5]]");
  const ImportedMap plain = imported(collection("", line), "plain.geojson");
  const std::string point =
      R"({"type": "Feature", "properties": {},
          "geometry": {"type": "Point", "coordinates": [13.4, 53.5]}}, )";
  for (const std::string& text :
       {collection(R"("bbox": [-180, -90, 180, 90], )", line), collection("", point + line)}) {
    const ImportedMap map = imported(text, "other.geojson");
    EXPECT_DOUBLE_EQ(map.map.origin.latitude_deg, plain.map.origin.latitude_deg);
    EXPECT_DOUBLE_EQ(map.map.origin.longitude_deg, plain.map.origin.longitude_deg);
    ASSERT_EQ(map.map.elements.size(), 1U);
    EXPECT_EQ(map.map.elements[0].points, plain.map.elements[0].points);
  }
  EXPECT_NEAR(plain.map.origin.latitude_deg, 52.5, 1e-6);
}

TEST(UnusualGeojson, ALargeMapSurvivesARoundTrip) {
  ImportedMap large;
  large.map.name = "large";
  large.map.origin = {49.0, 8.4};
  large.map.elements = {{ElementClass::kLaneDivider, Appearance::kSolid, {{0, 0}, {80, 5}}},
                        {ElementClass::kLaneDivider, Appearance::kSolid, {{-10, 0}, {-60, 5}}},
                        {ElementClass::kLaneDivider, Appearance::kSolid, {{55e3, 9e3}, {55e3, 0}}}};
  const auto text = to_geojson(large);
  ASSERT_TRUE(text.has_value());
  const ImportedMap again = imported(*text, "large.geojson");
  ASSERT_EQ(again.map.elements.size(), 3U);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < 2; ++k) {
      const Eigen::Vector2d moved =
          again.map.elements[i].points[k] - large.map.elements[i].points[k];
      EXPECT_LT(moved.norm(), 0.001) << "element " << i;
    }
  }
}

TEST(TangentPlane, APlaceIsTheInverseOfTheProjectionOfTheGround) {
  const GeographicLib::LocalCartesian plane(49.0, 8.4);
  for (const Eigen::Vector2d& point : {Eigen::Vector2d(0, 0), {5e3, -7e3}, {-9e4, 9e4}}) {
    const GeoOrigin place = place_of(plane, point);
    Eigen::Vector3d again;
    plane.Forward(place.latitude_deg, place.longitude_deg, 0.0, again.x(), again.y(), again.z());
    EXPECT_LT((again.head<2>() - point).norm(), 1e-4) << point.transpose();
  }
}

TEST(UnusualText, NamesThatAreNotUtf8AreWritten) {
  EXPECT_EQ(dump_json(nlohmann::json("b\xfcro")), "\"b\xef\xbf\xbdro\"");
  ImportedMap map;
  map.map.name = "b\xfcro";
  map.map.origin = {49.0, 8.4};
  const auto text = to_geojson(map);
  ASSERT_TRUE(text.has_value());
  EXPECT_THAT(*text, HasSubstr("b\xef\xbf\xbdro"));
}

TEST(UnusualText, OnlyTheOutermostElementSaysTheFormat) {
  const auto format_of = [](std::string_view text) {
    const auto format = find_map_format(text, "map.xml");
    return format ? std::string((*format)->name) : format.error().message;
  };
  EXPECT_EQ(format_of("<?xml version=\"1.0\"?>\n<!-- <osm-files value=\"a\"/> -->\n<OpenDRIVE/>"),
            "OpenDRIVE");
  EXPECT_EQ(format_of("\xEF\xBB\xBF<!DOCTYPE osm>\n<osm/>"), "Lanelet2");
  EXPECT_THAT(format_of("<!-- <osm/>"), HasSubstr("no map format"));
  EXPECT_THAT(format_of("<"), HasSubstr("no map format"));
}

TEST(UnusualText, AByteOrderMarkMayComeBeforeJson) {
  const std::string text = "\xEF\xBB\xBF" + collection("", divider("[[8.4, 49], [8.401, 49]]"));
  EXPECT_EQ(imported(text, "map.json").map.elements.size(), 1U);
  const auto broken = parse_imported(
      "\xEF\xBB\xBF\n" + collection("", "\n" + divider("[[8.4, 149]]")), "b.json", {});
  ASSERT_FALSE(broken.has_value());
  EXPECT_THAT(broken.error().message, HasSubstr("b.json:4: /features/0/geometry/coordinates/0"));
}

TEST(UnusualCompactMap, TheErrorOfADamagedOneSaysWhatToDo) {
  const std::string bytes = encode_map(HdMap{});
  const auto map =
      parse_imported(std::string_view(bytes).substr(0, bytes.size() - 1), "town.bvm", {});
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error().message, HasSubstr("make it again with `bevloc_convert_map`"));
}

TEST(UnusualArgoverse2, AnOutlineThatIsTooLongIsLeftOut) {
  const ImportedMap map = imported(R"({
 "lane_segments": {"1": {"id": 1, "lane_type": "VEHICLE", "successors": [],
   "left_lane_boundary": [{"x": 0, "y": 4, "z": 1}, {"x": 50, "y": 4, "z": 1}],
   "right_lane_boundary": [{"x": 0, "y": 0, "z": 1}, {"x": 50, "y": 0, "z": 1}],
   "left_lane_mark_type": "SOLID_WHITE", "right_lane_mark_type": "NONE"}},
 "pedestrian_crossings": {},
 "drivable_areas": {"8": {"id": 8, "area_boundary": [{"x": -5, "y": -1, "z": 1},
   {"x": 1e8, "y": -1, "z": 1}, {"x": 50, "y": 9, "z": 1}]}}})",
                                   "map.json");
  EXPECT_THAT(map.map.left_out, Contains(HasSubstr("found an outline of 2e+08 m")));
}

TEST(UnusualLanelet2, ANodeFarAwayDoesNotMoveTheMap) {
  const HdMap plain = imported(street(""), "street.osm").map;
  const HdMap stray = imported(street(R"(<node id="9" lat="0" lon="0"/>)"), "street.osm").map;
  EXPECT_DOUBLE_EQ(stray.origin.latitude_deg, plain.origin.latitude_deg);
  EXPECT_EQ(stray.elements.size(), plain.elements.size());
  const HdMap wrong_way = imported(street(R"(<node id="9" lat="0" lon="0"/>
        <way id="13"><nd ref="1"/><nd ref="9"/><tag k="type" v="curbstone"/></way>)"),
                                   "street.osm")
                              .map;
  EXPECT_NEAR(wrong_way.origin.latitude_deg, 49.0, 0.001);
  EXPECT_EQ(wrong_way.elements.size(), plain.elements.size());
  EXPECT_THAT(wrong_way.left_out, Contains(HasSubstr("node 9")));
}

TEST(UnusualLanelet2, NumbersMayHaveASignAndSpace) {
  EXPECT_EQ(imported(street("", " +49.0001 "), "street.osm").map.elements.size(), 2U);
}

TEST(UnusualLanelet2, AHeightThatIsNoNumberIsNoHeight) {
  const auto heights_with = [](std::string_view height) {
    return imported(street("", "49.0001", height), "street.osm").heights_m.at(0);
  };
  EXPECT_EQ(heights_with("12.5 m"), Heights({110.0, 12.5}));
  EXPECT_TRUE(heights_with("12,5").empty());
  EXPECT_TRUE(heights_with("nan").empty());
}

TEST(UnusualLanelet2, ACrossingHasTheHeightsOfItsBounds) {
  const ImportedMap map =
      imported(street(R"(<relation id="22"><member type="way" role="left" ref="12"/>
        <member type="way" role="right" ref="11"/><tag k="type" v="lanelet"/>
        <tag k="subtype" v="crosswalk"/></relation>)"),
               "street.osm");
  ASSERT_EQ(map.map.elements[0].element_class, ElementClass::kPedestrianCrossing);
  EXPECT_THAT(map.heights_m[0], testing::UnorderedElementsAre(110.0, 110.0, 111.0, 112.0));
}

TEST(UnusualLanelet2, ACrossingWithoutAnAreaIsLeftOut) {
  const HdMap map = imported(street(R"(<relation id="22"><member type="way" role="left" ref="11"/>
        <member type="way" role="right" ref="11"/><tag k="type" v="lanelet"/>
        <tag k="subtype" v="crosswalk"/></relation>)"),
                             "street.osm")
                        .map;
  EXPECT_THAT(map.left_out, Contains(HasSubstr("lanelet 22: found bounds without an area")));
}

TEST(UnusualLanelet2, TheReportNamesRelationsThatBecomeNothing) {
  const ImportedMap map = imported(street(R"(<relation id="30"><tag k="type" v="multipolygon"/>
        <tag k="subtype" v="crosswalk"/></relation>)"),
                                   "street.osm");
  const auto rows = map.report.rows();
  const auto row = std::ranges::find(rows, "relation multipolygon crosswalk", &ImportRow::kind);
  ASSERT_NE(row, rows.end());
  EXPECT_THAT(row->examples, Contains(HasSubstr("relation 30")));
}

TEST(UnusualLanelet2, LocalCoordinatesFarFromZeroAreShifted) {
  const std::string text = R"(<osm>
 <node id="1"><tag k="local_x" v="456000"/><tag k="local_y" v="5427000"/></node>
 <node id="2"><tag k="local_x" v="456080"/><tag k="local_y" v="5427000"/></node>
 <way id="11"><nd ref="1"/><nd ref="2"/><tag k="type" v="curbstone"/></way></osm>)";
  const ImportedMap map = imported(text, "local.osm");
  ASSERT_EQ(map.map.elements.size(), 1U);
  const auto& points = map.map.elements[0].points;
  EXPECT_LT(points[0].norm(), 200.0);
  EXPECT_DOUBLE_EQ((points[1] - points[0]).x(), 80.0);
  EXPECT_THAT(map.report.remarks(), Contains(HasSubstr("were shifted by")));
}

TEST(UnusualLanelet2, ReportsTheLengthOfWhatIsDropped) {
  const ImportedMap map = imported(R"(<osm>
<node id='1' lat='' lon=''><tag k='local_x' v='0'/><tag k='local_y' v='0'/></node>
<node id='2' lat='' lon=''><tag k='local_x' v='20'/><tag k='local_y' v='0'/></node>
<node id='3' lat='' lon=''><tag k='local_x' v='0'/><tag k='local_y' v='4'/></node>
<way id='10'><nd ref='1'/><nd ref='2'/><tag k='type' v='road_border'/></way>
<way id='12'><nd ref='1'/><nd ref='3'/><tag k='type' v='virtual'/></way>
<way id='13'><nd ref='1'/><nd ref='9'/><tag k='type' v='virtual'/></way>
</osm>
)",
                                   "town.osm");
  const auto rows = map.report.rows();
  const auto dropped = std::ranges::find(rows, "way virtual", &ImportRow::kind);
  ASSERT_NE(dropped, rows.end());
  EXPECT_EQ(dropped->count, 2U);
  EXPECT_DOUBLE_EQ(dropped->length_m, 4.0) << "node 9 is missing";
}

}  // namespace
}  // namespace bevloc
