#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/opendrive/road.h"
#include "tests/pipeline/map/formats/opendrive_file.h"

namespace bevloc {
namespace {

using opendrive::Geometry;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using test::file_with;
using test::good;
using test::kLanes;
using test::kStraight;
using test::of;
using test::read;
using test::road_error;
using test::road_with;

/// kLanes with another start of its section.
std::string lanes_with(std::string_view start) {
  return std::string(kLanes).replace(kLanes.find("0"), 1, start);
}

TEST(OpendriveGeometry, AnArcEndsWhereItsCircleDoes) {
  Geometry arc;
  arc.kind = Geometry::Kind::kArc;
  arc.length_m = 10.0 * std::numbers::pi;
  arc.start_curvature = 0.05;  // radius 20 m: a quarter of the circle
  arc.origin = {3.0, 4.0};
  arc.heading_rad = 0.5 * std::numbers::pi;
  const auto pose = opendrive::pose_along(arc, arc.length_m);
  EXPECT_NEAR(pose.position.x(), 3.0 - 20.0, 1e-9);
  EXPECT_NEAR(pose.position.y(), 4.0 + 20.0, 1e-9);
  EXPECT_NEAR(pose.heading_rad, std::numbers::pi, 1e-12);
}

TEST(OpendriveGeometry, ASpiralAgreesWithSmallSteps) {
  Geometry spiral;
  spiral.kind = Geometry::Kind::kSpiral;
  spiral.length_m = 60.0;
  spiral.start_curvature = -0.01;
  spiral.end_curvature = 0.08;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  constexpr int kSteps = 200'000;
  const double step_m = spiral.length_m / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) * step_m;
    const double heading = s * (-0.01 + 0.5 * 0.09 / 60.0 * s);
    place += step_m * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  }
  const auto pose = opendrive::pose_along(spiral, spiral.length_m);
  EXPECT_NEAR((pose.position - place).norm(), 0.0, 1e-5);
  EXPECT_NEAR(pose.heading_rad, 0.5 * (-0.01 + 0.08) * 60.0, 1e-12);
}

TEST(OpendriveGeometry, CubicsGiveTheSameCurveInAllThreeWays) {
  // v = 0.002 u^2; the length of the curve up to u = 40 is known in closed form.
  const double slope = 0.004 * 40.0;
  const double length_m = 0.5 * 40.0 * std::hypot(1.0, slope) + 0.5 / 0.004 * std::asinh(slope);
  Geometry poly;
  poly.kind = Geometry::Kind::kPoly3;
  poly.length_m = length_m;
  poly.v = {0.0, 0.0, 0.0, 0.002, 0.0};
  const auto end = opendrive::pose_along(poly, length_m);
  EXPECT_NEAR(end.position.x(), 40.0, 1e-6);
  EXPECT_NEAR(end.position.y(), 3.2, 1e-6);
  EXPECT_NEAR(end.heading_rad, std::atan(slope), 1e-9);

  Geometry param = poly;
  param.kind = Geometry::Kind::kParamPoly3;
  param.is_normalized = true;
  param.u = {0.0, 0.0, 40.0, 0.0, 0.0};
  param.v = {0.0, 0.0, 0.0, 0.002 * 1600.0, 0.0};
  EXPECT_NEAR((opendrive::pose_along(param, length_m).position - end.position).norm(), 0.0, 1e-6);
  param.is_normalized = false;  // now in metres along u
  param.u = {0.0, 0.0, 1.0, 0.0, 0.0};
  param.v = {0.0, 0.0, 0.0, 0.002, 0.0};
  EXPECT_NEAR(opendrive::pose_along(param, 40.0).position.y(), 3.2, 1e-12);
}

TEST(Opendrive, MarksAndEdgesLieWhereTheWidthsSay) {
  const ImportedMap imported = good(file_with(road_with(kStraight, kLanes)));
  const auto dashed = of(imported, ElementClass::kLaneDivider, Appearance::kDashed);
  ASSERT_EQ(dashed.size(), 1U);
  EXPECT_EQ(dashed[0].points.front(), Eigen::Vector2d(0, 0));
  EXPECT_EQ(dashed[0].points.back(), Eigen::Vector2d(40, 0)) << "the mark changes at 40 m";
  const auto solid = of(imported, ElementClass::kLaneDivider, Appearance::kSolid);
  ASSERT_EQ(solid.size(), 1U) << "the painted outer edge of lane 1 is the edge of the road";
  EXPECT_EQ(solid[0].points.back(), Eigen::Vector2d(100, 0));

  const auto kerb = of(imported, ElementClass::kRoadBoundary, Appearance::kKerb);
  ASSERT_EQ(kerb.size(), 1U) << "between shoulder and sidewalk";
  EXPECT_NEAR(kerb[0].points.front().y(), -4.5, 1e-9);
  EXPECT_NEAR(kerb[0].points.back().y(), -5.5, 1e-9) << "the shoulder widens by 1 m in 100 m";
  const auto edge = of(imported, ElementClass::kRoadBoundary, Appearance::kRoadEdge);
  ASSERT_EQ(edge.size(), 1U);
  EXPECT_NEAR(edge[0].points.front().y(), 3.5, 1e-9);
  ASSERT_EQ(imported.map.lanes.size(), 2U);
  EXPECT_NEAR(imported.map.lanes[1].centerline.front().x(), 100.0, 1e-9)
      << "left lanes run against the road";
}

TEST(Opendrive, KeepsHeightsAndAppliesLaneOffsets) {
  const ImportedMap imported = good(file_with(
      road_with(kStraight, kLanes, "", R"(<laneOffset s="50" a="2" b="0" c="0" d="0"/>)")));
  const auto& elements = imported.map.elements;
  ASSERT_EQ(imported.heights_m.size(), elements.size());
  for (size_t i = 0; i < elements.size(); ++i) {
    ASSERT_EQ(imported.heights_m[i].size(), elements[i].points.size());
    EXPECT_NEAR(imported.heights_m[i][0], 5.0 + 0.02 * elements[i].points[0].x(), 1e-9);
  }
  const auto solid = of(imported, ElementClass::kLaneDivider, Appearance::kSolid);
  EXPECT_NEAR(solid.at(0).points.back().y(), 2.0, 1e-9);
}

TEST(Opendrive, CrosswalksHaveTheirOutlineInBothFrames) {
  const ImportedMap imported = good(file_with(road_with(kStraight, kLanes, R"(
    <object id="1" type="crosswalk" s="20" t="1" hdg="1.5707963267948966"><outline>
      <cornerLocal u="4" v="1"/><cornerLocal u="4" v="-1"/><cornerLocal u="-4" v="-1"/>
      <cornerLocal u="-4" v="1"/><cornerLocal u="4" v="1"/></outline></object>
    <object id="2" type="crosswalk" s="0" t="0"><outlines><outline>
      <cornerRoad s="60" t="3"/><cornerRoad s="63" t="3"/><cornerRoad s="63" t="-3"/>
    </outline></outlines></object>
    <object id="3" type="tree" s="9" t="9"/>)")));
  const auto crossings = of(imported, ElementClass::kPedestrianCrossing, Appearance::kUnknown);
  ASSERT_EQ(crossings.size(), 2U);
  ASSERT_EQ(crossings[0].points.size(), 4U) << "the repeated corner is left out";
  EXPECT_NEAR((crossings[0].points[0] - Eigen::Vector2d(19.0, 5.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((crossings[1].points[1] - Eigen::Vector2d(63.0, 3.0)).norm(), 0.0, 1e-9);
}

TEST(Opendrive, RoadsOfAJunctionHaveNoEdgesWithinEachOther) {
  constexpr std::string_view kPlain =
      R"(<laneSection s="0"><center><lane id="0" type="none"/></center>
    <right><lane id="-1" type="driving"><width sOffset="0" a="6" b="0" c="0" d="0"/></lane></right>
    </laneSection>)";
  const std::string crossing =
      R"(<geometry s="0" x="47" y="-50" hdg="1.5707963267948966" length="100"><line/></geometry>)";
  const ImportedMap imported = good(file_with(road_with(kStraight, kPlain, "", "", "4") +
                                              road_with(crossing, kPlain, "", "", "4")));
  for (const MapElement& element : imported.map.elements) {
    for (size_t i = 0; i + 1 < element.points.size(); ++i) {
      const Eigen::Vector2d middle = 0.5 * (element.points[i] + element.points[i + 1]);
      const bool inside_first = middle.y() < -0.5 && middle.y() > -5.5;
      const bool inside_second = middle.x() > 47.5 && middle.x() < 52.5;
      EXPECT_FALSE(inside_first || inside_second) << middle.transpose();
    }
  }
  EXPECT_EQ(imported.map.elements.size(), 8U) << "four corners of two edges each";
}

TEST(Opendrive, TheGeoreferenceGivesThePlaceOnEarth) {
  const std::string utm =
      "<geoReference><![CDATA[+proj=utm +zone=32 +datum=WGS84 +units=m +no_defs]]></geoReference>"
      "<offset x=\"456000\" y=\"5429000\" z=\"0\" hdg=\"0\"/>";
  const ImportedMap imported = good(file_with(road_with(kStraight, kLanes), utm));
  EXPECT_NEAR(imported.map.origin.latitude_deg, 49.0117, 1e-3);
  EXPECT_NEAR(imported.map.origin.longitude_deg, 8.3986, 1e-3);
  const auto dashed = of(imported, ElementClass::kLaneDivider, Appearance::kDashed);
  const double length_m = (dashed.at(0).points.back() - dashed.at(0).points.front()).norm();
  EXPECT_NEAR(length_m, 40.0 / 0.9996, 2e-3) << "UTM shrinks lengths near its meridian";
}

TEST(Opendrive, AGeoreferenceThatCannotBeReadIsRefusedWithItsLine) {
  const std::string text =
      file_with(road_with(kStraight, kLanes), "\n<geoReference>+proj=aea +lat_1=29</geoReference>");
  EXPECT_EQ(
      road_error(text),
      "town.xodr:4: <geoReference>: found +proj=aea, wanted utm or tmerc; --origin "
      "LATITUDE,LONGITUDE takes its place; or delete the geoReference, and the map has no place "
      "on earth");
  ImportOptions options;
  options.origin = GeoOrigin{49.0, 8.0};
  const auto imported = read(text, options);
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  EXPECT_NEAR(imported->map.origin.latitude_deg, 49.0, 1e-2);
}

TEST(Opendrive, RefusesBrokenFilesWithTheirLine) {
  EXPECT_THAT(road_error("<OpenDRIVE><road>"),
              HasSubstr("town.xodr:1: found text that is not XML"));
  EXPECT_THAT(road_error("<osm/>"), HasSubstr("wanted <OpenDRIVE>"));
  EXPECT_THAT(road_error(file_with("")), HasSubstr("town.xodr:2: found no <road>"));
  EXPECT_EQ(road_error(file_with(road_with(
                R"(<geometry s="0" x="a" y="0" hdg="0" length="100"><line/></geometry>)", kLanes))),
            "town.xodr:4: <geometry>: found x=\"a\", wanted a number from -1e+09 to 1e+09");
  EXPECT_THAT(road_error(file_with(road_with(
                  R"(<geometry s="0" x="0" y="0" hdg="0" length="9"><bow/></geometry>)", kLanes))),
              HasSubstr("wanted line, arc, spiral, poly3 or paramPoly3"));
  EXPECT_THAT(road_error(file_with(road_with("", kLanes))),
              HasSubstr("<road>: found no <geometry>"));
  EXPECT_THAT(road_error(file_with(road_with(kStraight, ""))), HasSubstr("found no <laneSection>"));
  EXPECT_THAT(road_error(file_with(
                  road_with(kStraight, R"(<laneSection s="0"><center><lane id="0"/></center><right>
                  <lane id="-2" type="driving"/></right></laneSection>)"))),
              HasSubstr("lane -2 without its inner neighbour"));
  EXPECT_THAT(road_error(file_with(road_with(kStraight, kLanes, "", "", "-1", 1e7))),
              HasSubstr("town.xodr:4: <road>: found length"));
}

TEST(Opendrive, TheClassTableOverridesMarks) {
  const auto table = ClassTable::parse(
      "rules:\n  - kind: road mark broken\n    becomes: nothing\n"
      "  - kind: edge of driving*\n    becomes: divider\n    appearance: solid\n",
      "classes.yaml");
  ASSERT_TRUE(table.has_value()) << table.error().message;
  ImportOptions options;
  options.classes = &*table;
  const auto imported = read(file_with(road_with(kStraight, kLanes)), options);
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  EXPECT_TRUE(of(*imported, ElementClass::kLaneDivider, Appearance::kDashed).empty());
  EXPECT_EQ(of(*imported, ElementClass::kLaneDivider, Appearance::kSolid).size(), 2U);
  EXPECT_TRUE(of(*imported, ElementClass::kRoadBoundary, Appearance::kRoadEdge).empty());
}

TEST(Opendrive, ALonglatGeoreferenceDoesNotSayWhereMetresLie) {
  const ImportedMap imported =
      good(file_with(road_with(kStraight, kLanes), "<geoReference>+proj=longlat</geoReference>"));
  const auto dashed = of(imported, ElementClass::kLaneDivider, Appearance::kDashed);
  EXPECT_EQ(dashed.at(0).points.back(), Eigen::Vector2d(40, 0)) << "metres, not degrees";
  EXPECT_THAT(imported.report.remarks(), testing::Contains(HasSubstr("--origin")));
}

TEST(Opendrive, TheOtherSideOfASingleSidedSectionGoesOn) {
  constexpr std::string_view kSides = R"(
  <laneSection s="0" singleSide="true"><left><lane id="1" type="driving">
      <width sOffset="0" a="3.5" b="0.01" c="0" d="0"/></lane></left>
    <center><lane id="0"><roadMark sOffset="0" type="broken"/></lane></center></laneSection>
  <laneSection s="0" singleSide="true"><center><lane id="0"/></center>
    <right><lane id="-1" type="driving"><width sOffset="0" a="3" b="0" c="0" d="0"/></lane></right>
  </laneSection>
  <laneSection s="40" singleSide="true"><center><lane id="0"/></center>
    <right><lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right>
  </laneSection>)";
  const ImportedMap imported = good(file_with(road_with(kStraight, kSides)));
  EXPECT_THAT(imported.map.left_out, IsEmpty());
  const auto dashed = of(imported, ElementClass::kLaneDivider, Appearance::kDashed);
  ASSERT_EQ(dashed.size(), 2U) << "one for each part of the road";
  EXPECT_EQ(dashed[1].points.back(), Eigen::Vector2d(100, 0));
  const auto edges = of(imported, ElementClass::kRoadBoundary, Appearance::kRoadEdge);
  ASSERT_EQ(edges.size(), 4U) << "two sides of two parts";
  EXPECT_NEAR(edges[0].points.front().y(), -3.0, 1e-9);
  EXPECT_NEAR(edges[1].points.back().y(), 3.9, 1e-9);
  EXPECT_NEAR(edges[2].points.front().y(), -4.0, 1e-9);
  EXPECT_NEAR(edges[3].points.back().y(), 4.5, 1e-9) << "the left lane goes on to widen";
  EXPECT_EQ(imported.map.lanes.size(), 4U);
}

TEST(Opendrive, NamesPartsOfARoadThatAreLost) {
  const std::string late =
      lanes_with("30") + "<laneSection s=\"130\"><center><lane id=\"0\"/></center></laneSection>";
  const ImportedMap imported = good(file_with(road_with(kStraight, late, "", "", "-1", 120.0)));
  EXPECT_THAT(
      imported.map.left_out,
      ElementsAre(HasSubstr("road 7: found a length of 120 m, wanted 100 m, where its <planView>"),
                  "town.xodr:6: road 7: found the first <laneSection> at s=30, wanted s=0",
                  HasSubstr("road 7: found a <laneSection> at s=130, wanted at most")));
  const std::string late_line =
      R"(<geometry s="20" x="0" y="0" hdg="0" length="80"><line/></geometry>)";
  EXPECT_THAT(good(file_with(road_with(late_line, kLanes))).map.left_out,
              ElementsAre(HasSubstr("found the first <geometry> at s=20, wanted s=0")));
  EXPECT_THAT(road_error(file_with(road_with(kStraight, kLanes, "", "", "-1", 0.0))),
              HasSubstr("road 7: found a length of 0 m, wanted 100 m"));
}

TEST(Opendrive, AJumpOfTheReferenceLineIsNotALine) {
  constexpr std::string_view kJump =
      R"(<geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry>
      <geometry s="50" x="50" y="30" hdg="0" length="20"><line/></geometry>
      <geometry s="80" x="80" y="30" hdg="0" length="20"><line/></geometry>)";
  const ImportedMap imported = good(file_with(road_with(
      kJump, kLanes, R"(<object id="1" type="crosswalk" s="75" t="0" length="4" width="7"/>)")));
  EXPECT_THAT(imported.map.left_out,
              ElementsAre(HasSubstr("road 7: found a gap of 30 m after s=50, wanted"),
                          HasSubstr("road 7: found a gap of 10 m after s=70, wanted"),
                          HasSubstr("object 1: found 4 of 4 corners beyond the road")));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& edge : of(imported, ElementClass::kRoadBoundary, Appearance::kRoadEdge)) {
    sum += edge.points.back() - edge.points.front();
  }
  EXPECT_NEAR((sum - Eigen::Vector2d(90, 0)).norm(), 0.0, 1e-9) << "all but jump and gap";
}

TEST(Opendrive, CrosswalksBeyondTheRoadAreLeftOut) {
  const ImportedMap imported = good(file_with(road_with(kStraight, kLanes, R"(
    <object id="1" type="crosswalk" s="500" t="0" length="4" width="7"/>
    <object id="2" type="crosswalk" s="-20" t="0" length="4" width="7"/>)")));
  EXPECT_TRUE(of(imported, ElementClass::kPedestrianCrossing, Appearance::kUnknown).empty());
  EXPECT_THAT(imported.map.left_out,
              ElementsAre(HasSubstr("road 7: object 1: found 4 of 4 corners beyond the road"),
                          HasSubstr("object 2: found 4 of 4 corners")));
}

TEST(Opendrive, EveryOutlineAndCopyOfACrosswalkIsACrossing) {
  const ImportedMap imported = good(file_with(road_with(kStraight, kLanes, R"(
    <object id="1" type="crosswalk" s="50" t="0"><outlines>
      <outline><cornerRoad s="9" t="3"/><cornerRoad s="7" t="0"/><cornerRoad s="9" t="0"/></outline>
      <outline><cornerRoad s="4" t="3"/><cornerRoad s="1" t="0"/><cornerRoad s="4" t="0"/></outline>
      <outline outer="false"><cornerRoad s="3" t="1"/><cornerRoad s="3" t="0"/></outline>
      </outlines></object>
    <object id="2" type="crosswalk" s="9" t="0" length="4" width="7">
      <repeat s="20" length="60" distance="30" tStart="0" tEnd="2"/></object>
    <object id="3" type="crosswalk" s="9" t="0" length="4" width="7">
      <repeat s="20" length="60" distance="0"/></object>)")));
  const auto crossings = of(imported, ElementClass::kPedestrianCrossing, Appearance::kUnknown);
  ASSERT_EQ(crossings.size(), 6U);
  EXPECT_EQ(crossings[1].points[0], Eigen::Vector2d(4, 3));
  EXPECT_EQ(crossings[2].points[0], Eigen::Vector2d(22, 3.5));
  EXPECT_EQ(crossings[3].points[0], Eigen::Vector2d(52, 4.5));
  EXPECT_EQ(crossings[4].points[0], Eigen::Vector2d(82, 5.5));
  EXPECT_EQ(crossings[5].points[0], Eigen::Vector2d(11, 3.5)) << "once, and named";
  EXPECT_THAT(imported.map.left_out, ElementsAre(HasSubstr("road 7: object 3: found a <repeat>")));
}

TEST(Opendrive, RoundingNoiseIsZero) {
  const ImportedMap imported = good(file_with(
      road_with(R"(<geometry s="-1e-12" x="1e-400" y="0" hdg="0" length="100"><line/></geometry>)",
                lanes_with("-1e-7"))));
  EXPECT_THAT(imported.map.left_out, IsEmpty());
  const auto dashed = of(imported, ElementClass::kLaneDivider, Appearance::kDashed);
  EXPECT_EQ(dashed.at(0).points.front(), Eigen::Vector2d(0, 0));
  for (const char* bad : {"-0.01", "1e400", "-1e400"}) {
    EXPECT_THAT(road_error(file_with(road_with(kStraight, lanes_with(bad)))),
                HasSubstr("found s="));
  }
}

TEST(Opendrive, WithoutAnElevationProfileThereAreNoHeights) {
  std::string text =
      file_with(road_with(kStraight, kLanes, R"(<object type="crosswalk" length="4" width="7"/>)"));
  const size_t begin = text.find("<elevationProfile>");
  text.erase(begin, text.find("<lanes>") - begin);
  const ImportedMap imported = good(text);
  EXPECT_EQ(imported.map.elements.size(), 5U);
  EXPECT_THAT(imported.heights_m, testing::Each(IsEmpty()));
}

}  // namespace
}  // namespace bevloc
