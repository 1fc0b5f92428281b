// Where an imported map lies on earth.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/geojson.h"
#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/tangent_plane.h"
#include "tests/pipeline/map/formats/imported_map.h"

namespace bevloc {
namespace {

using test::import_error;
using testing::Contains;
using testing::HasSubstr;

/// A straight road of 1000 m to the east, from a point of the file.
std::string road_from(double x_m, double y_m, std::string_view reference = "") {
  return fmt::format(
      R"(<OpenDRIVE><header revMajor="1">{}</header><road id="1" length="1000" junction="-1">
<planView><geometry s="0" x="{}" y="{}" hdg="0" length="1000"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0"><roadMark sOffset="0" type="solid"/></lane></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right>
</laneSection></lanes></road></OpenDRIVE>)",
      reference.empty() ? "" : fmt::format("<geoReference>{}</geoReference>", reference), x_m, y_m);
}

ImportOptions with_origin() {
  ImportOptions options;
  options.origin = GeoOrigin{49.0, 8.4};
  return options;
}

TEST(Placement, AnOriginFarFromTheCoordinatesIsRefused) {
  EXPECT_EQ(import_error(road_from(455'000, 5'428'000), "utm.xodr", with_origin()),
            "utm.xodr: found a map whose middle is at (456000, 5428000) m, wanted it within 83 km "
            "of (0, 0), because --origin gives the place of (0, 0)");
  EXPECT_EQ(import_error(road_from(80'000, -80'000), "far.xodr", with_origin()), "");
  EXPECT_THAT(import_error(R"(<osm>
 <node id="1"><tag k="local_x" v="456000"/><tag k="local_y" v="5427000"/></node>
 <node id="2"><tag k="local_x" v="456080"/><tag k="local_y" v="5427000"/></node>
 <way id="11"><nd ref="1"/><nd ref="2"/><tag k="type" v="curbstone"/></way></osm>)",
                           "local.osm", with_origin()),
              testing::StartsWith("local.osm: found a map whose middle is at (456"));
}

TEST(Placement, WordsOfProjThatAreNotKnownAreRefused) {
  const auto error_with = [](const std::string& words) {
    return import_error(road_from(0, 0, "+proj=tmerc +lat_0=49 +lon_0=8 " + words), "proj.xodr");
  };
  for (const char* words :
       {"+pm=paris", "+a=6377397.155", "+b=6356078.963", "+R=6371000", "+K_0=0.9996",
        "+towgs84=598.1,73.7,418.2,0.202,0.045,-2.455,6.7", "+nadgrids=BETA2007.gsb"}) {
    const std::string word(words, std::string_view(words).find('='));
    EXPECT_THAT(error_with(words), HasSubstr("<geoReference>: found " + word)) << words;
    EXPECT_THAT(error_with(words), HasSubstr("; --origin LATITUDE,LONGITUDE takes its place"));
    EXPECT_THAT(
        import_error(road_from(5e5, 5.4e6, std::string("+proj=utm +zone=32 ") + words), "u.xodr"),
        HasSubstr("found " + word));
  }
  for (const char* words :
       {"+k=1 +x_0=0 +y_0=0 +ellps=WGS84 +units=m +geoidgrids=egm96_15.gtx +vunits=m +no_defs",
        "+k_0=0.9996 +datum=WGS84 +type=crs +wktext +axis=enu +to_meter=1",
        "+ellps=GRS80 +towgs84=0,0,0,0,0,0,0 +pm=greenwich +nadgrids=@null +over +approx",
        "+datum=NAD83 +no_defs"}) {
    EXPECT_EQ(error_with(words), "");
  }
}

TEST(Placement, OnlyAMapNearZeroIsToldOfTheOrigin) {
  constexpr std::string_view kDelete = "delete the geoReference, and the map has no place on earth";
  const std::string start = "map.xodr:1: <geoReference>: found +proj=aea, wanted utm or tmerc; ";
  EXPECT_EQ(import_error(road_from(4'468'000, 5'333'000, "+proj=aea"), "map.xodr"),
            fmt::format("{}{}", start, kDelete));
  EXPECT_EQ(import_error(road_from(0, 0, "+proj=aea"), "map.xodr"),
            fmt::format("{}--origin LATITUDE,LONGITUDE takes its place; or {}", start, kDelete));
}

TEST(Placement, EpsgCodesOfUtmZonesAreRead) {
  const auto origin_with = [](const std::string& reference) {
    const auto map = parse_imported(road_from(455'000, 5'428'000, reference), "epsg.xodr", {});
    EXPECT_TRUE(map.has_value()) << map.error().message;
    return map ? map->map.origin : GeoOrigin{};
  };
  for (const auto& [code, words] : std::vector<std::pair<std::string, std::string>>{
           {"+init=epsg:32632 +no_defs", "+proj=utm +zone=32"},
           {"+init=EPSG:32760", "+proj=utm +zone=60 +south"},
           {"+init=epsg:25832", "+proj=utm +zone=32 +ellps=GRS80"}}) {
    const GeoOrigin found = origin_with(code);
    const GeoOrigin wanted = origin_with(words);
    EXPECT_DOUBLE_EQ(found.latitude_deg, wanted.latitude_deg) << code;
    EXPECT_DOUBLE_EQ(found.longitude_deg, wanted.longitude_deg) << code;
    EXPECT_TRUE(is_known(found)) << code;
  }
  for (const std::string code : {"epsg:31467", "epsg:32661", "epsg:25839", "esri:32632"}) {
    EXPECT_THAT(import_error(road_from(0, 0, "+init=" + code), "epsg.xodr"),
                HasSubstr("found +init=" + code + ", wanted the EPSG code of a UTM zone"));
  }
}

TEST(Placement, UtmNeedsItsZone) {
  EXPECT_THAT(import_error(road_from(0, 0, "+proj=utm +ellps=WGS84"), "utm.xodr"),
              HasSubstr("found no +zone, wanted 1 to 60"));
  EXPECT_THAT(import_error(road_from(0, 0, "+proj=utm +zone=61"), "utm.xodr"),
              HasSubstr("found +zone=61, wanted"));
}

TEST(Placement, UtmCoordinatesNearZeroAreRefused) {
  for (const char* words :
       {"+proj=utm +zone=32 +datum=WGS84", "+proj=utm +zone=32 +south +datum=WGS84",
        "+proj=tmerc +lat_0=0 +lon_0=9 +x_0=3500000"}) {
    EXPECT_THAT(import_error(road_from(0, 0, words), "utm.xodr"),
                testing::AllOf(
                    HasSubstr("utm.xodr:1: <geoReference>: found the middle of the map at ("),
                    HasSubstr(" km from the meridian of the projection, wanted at most 400 km; add "
                              "the missing <offset>"),
                    HasSubstr("; --origin LATITUDE,LONGITUDE takes its place")))
        << words;
    EXPECT_EQ(import_error(road_from(0, 0, words), "utm.xodr", with_origin()), "");
  }
  EXPECT_THAT(import_error(road_from(3'456'000, 5'429'000, "+proj=utm +zone=32"), "utm.xodr"),
              HasSubstr("add the missing <offset>"));
}

TEST(Placement, OneZoneMayServeAWholeCountry) {
  // Norway uses zone 33 as far as its west coast.
  const auto map =
      parse_imported(road_from(-30'000, 6'700'000, "+init=epsg:25833"), "norway.xodr", {});
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_NEAR(map->map.origin.latitude_deg, 60.09, 0.02);
  EXPECT_NEAR(map->map.origin.longitude_deg, 5.46, 0.02);
  EXPECT_THAT(map->report.remarks(), Contains(HasSubstr("look whether that is right")));
}

TEST(Placement, AnOriginFarFromTheMapNeedsXToTheEast) {
  const auto remarks_from = [](double x_m) {
    const auto map = parse_imported(road_from(x_m, 0.0), "road.xodr", with_origin());
    EXPECT_TRUE(map.has_value()) << map.error().message;
    return map ? map->report.remarks() : std::vector<std::string>{};
  };
  EXPECT_THAT(remarks_from(0.0), testing::IsEmpty());
  EXPECT_THAT(remarks_from(36'000.0),
              testing::ElementsAre(testing::AllOf(HasSubstr("km from (0, 0), so x must point to"),
                                                  HasSubstr("add the tag mgrs_code"))));
}

TEST(Placement, TheOriginOfAFileIsExactFarFromIt) {
  const GeographicLib::LocalCartesian plane(49.0, 8.4);
  for (const double x_m : {0.0, 36'000.0, 70'000.0}) {
    const auto imported = parse_imported(road_from(x_m, 0.0), "road.xodr", with_origin());
    ASSERT_TRUE(imported.has_value()) << imported.error().message;
    const GeographicLib::LocalCartesian own(imported->map.origin.latitude_deg,
                                            imported->map.origin.longitude_deg);
    const GeoOrigin start = place_of(own, imported->map.elements.back().points.front());
    EXPECT_LT((point_of(plane, start) - Eigen::Vector2d(x_m, 0.0)).norm(), 0.001) << x_m;
  }
}

TEST(Placement, GeojsonKeepsPlacesFarFromTheMiddle) {
  // Most lines lie at longitude 8.4, one about 70 km to the east.
  constexpr std::string_view kLine =
      R"({{"type": "Feature", "properties": {{"class": "divider"}},
          "geometry": {{"type": "LineString", "coordinates": [[{}, 49], [{}, 49.001]]}}}})";
  std::string features;
  for (const double longitude_deg : {8.4, 8.4, 8.4, 9.36}) {
    features += fmt::format("{}{}", features.empty() ? "" : ",",
                            fmt::format(fmt::runtime(kLine), longitude_deg, longitude_deg));
  }
  const auto imported =
      parse_imported(fmt::format(R"({{"type": "FeatureCollection", "features": [{}]}})", features),
                     "wide.geojson", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  const GeographicLib::LocalCartesian plane(imported->map.origin.latitude_deg,
                                            imported->map.origin.longitude_deg);
  const GeoOrigin place = place_of(plane, imported->map.elements.back().points.front());
  // 1e-8 degrees are 1 mm.
  EXPECT_NEAR(place.longitude_deg, 9.36, 1e-8);
  EXPECT_NEAR(place.latitude_deg, 49.0, 1e-8);
  const auto text = to_geojson(*imported);
  ASSERT_TRUE(text.has_value());
  EXPECT_THAT(*text, HasSubstr("[9.36,49.0]"));
}

TEST(Placement, TheOtherSideOfTheEarthIsFarAway) {
  constexpr std::string_view kTwoSides = R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"class": "divider"}, "geometry": {"type": "LineString",
     "coordinates": [[8.4, 49], [8.4001, 49], [8.4002, 49]]}},
    {"type": "Feature", "properties": {"class": "divider"}, "geometry": {"type": "LineString",
     "coordinates": [[-171.6, -49], [-171.599, -49]]}}]})";
  const auto imported = parse_imported(kTwoSides, "sides.geojson", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  EXPECT_EQ(imported->map.elements.size(), 1U);
  EXPECT_THAT(imported->map.left_out, Contains(HasSubstr("too far from the middle")));
  size_t taken = 0;
  size_t far = 0;
  for (const ImportRow& row : imported->report.rows()) {
    taken += row.meaning ? row.count : 0;
    far += row.why == "too far from the middle" ? row.count : 0;
  }
  EXPECT_EQ(taken, 1U) << "the report counts what the map has";
  EXPECT_EQ(far, 1U);

  const auto lanelet = parse_imported(R"(<osm>
 <node id="1" lat="49" lon="8.4"/><node id="2" lat="49" lon="8.401"/>
 <node id="3" lat="49" lon="8.402"/>
 <node id="4" lat="-49" lon="-171.6"/><node id="5" lat="-49" lon="-171.599"/>
 <way id="11"><nd ref="1"/><nd ref="2"/><nd ref="3"/><tag k="type" v="curbstone"/></way>
 <way id="12"><nd ref="4"/><nd ref="5"/><tag k="type" v="curbstone"/></way></osm>)",
                                      "sides.osm", {});
  ASSERT_TRUE(lanelet.has_value()) << lanelet.error().message;
  EXPECT_EQ(lanelet->map.elements.size(), 1U);
  EXPECT_THAT(lanelet->map.left_out, Contains(HasSubstr("node 4: found a place (1.27")));
}

}  // namespace
}  // namespace bevloc
