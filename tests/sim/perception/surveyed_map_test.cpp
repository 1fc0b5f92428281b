#include "sim/perception/surveyed_map.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/perception/matching_scene.h"
#include "sim/world/world_generator.h"
#include "tests/sim/perception/small_maps.h"

namespace bevloc::sim {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A road with kerbs and a dashed divider, which the map has 5 cm too far left.
World road_with_dashes(double phase_m) {
  World world;
  world.map = open_road();
  world.map.elements[1].appearance = Appearance::kDashed;
  world.map.elements[1].points = along_x(0.0, 20.0, 0.05);
  world.paint_lines.push_back({.points = along_x(0.0, 20.0, 3.0), .dash_m = 1.0, .gap_m = 1.0});
  world.paint_lines.push_back(
      {.points = along_x(0.0, 20.0, 0.0), .dash_m = 3.0, .gap_m = 5.0, .phase_m = phase_m});
  return world;
}

bool is_whole(const std::vector<Dash>& dashes) {
  return dashes.size() == 1 && dashes[0].from_m == 0.0 && std::isinf(dashes[0].to_m);
}

TEST(PaintedDashes, LieWhereThePaintIs) {
  const MapDashes dashes =
      painted_dashes(road_with_dashes(9.0));  // the line begins 1 m after the start of a dash
  ASSERT_THAT(dashes, SizeIs(3));
  EXPECT_TRUE(is_whole(dashes[0]));
  EXPECT_TRUE(is_whole(dashes[2]));
  ASSERT_THAT(dashes[1], SizeIs(3));
  EXPECT_NEAR(dashes[1][0].from_m, 0.0, 1e-9);
  EXPECT_NEAR(dashes[1][0].to_m, 2.0, 1e-9);
  EXPECT_NEAR(dashes[1][1].from_m, 7.0, 1e-9);
  EXPECT_NEAR(dashes[1][1].to_m, 10.0, 1e-9);
  EXPECT_NEAR(dashes[1][2].from_m, 15.0, 1e-9);
  EXPECT_NEAR(dashes[1][2].to_m, 18.0, 1e-9);
}

TEST(PaintedDashes, EndWithTheLine) {
  const MapDashes dashes = painted_dashes(road_with_dashes(6.0));  // dashes begin at 2, 10 and 18 m
  ASSERT_THAT(dashes[1], SizeIs(3));
  EXPECT_NEAR(dashes[1][2].from_m, 18.0, 1e-9);
  EXPECT_NEAR(dashes[1][2].to_m, 20.0, 1e-9);
}

TEST(PaintedDashes, AnUnpaintedDividerIsContinuous) {
  World world = road_with_dashes(0.0);
  world.paint_lines.pop_back();
  EXPECT_TRUE(is_whole(painted_dashes(world)[1]));
}

TEST(SurveyedMap, HasAnElementForEveryDash) {
  World world = road_with_dashes(9.0);
  world.map.name = "a road";
  world.map.lanes.resize(2);
  const HdMap map = surveyed_map(world.map, painted_dashes(world));
  EXPECT_EQ(map.name, "a road");
  EXPECT_THAT(map.lanes, SizeIs(2));
  ASSERT_THAT(map.elements, SizeIs(5));
  EXPECT_EQ(map.elements[0].points, world.map.elements[0].points);
  EXPECT_EQ(map.elements[4].points, world.map.elements[2].points);
  const MapElement& dash = map.elements[2];
  EXPECT_EQ(dash.element_class, ElementClass::kLaneDivider);
  ASSERT_THAT(dash.points, SizeIs(2));
  EXPECT_TRUE(dash.points[0].isApprox(Eigen::Vector2d(7.0, 0.05)));
  EXPECT_TRUE(dash.points[1].isApprox(Eigen::Vector2d(10.0, 0.05)));
}

TEST(SurveyedMap, WithoutDashesEqualsTheMap) {
  const HdMap map = open_road();
  EXPECT_THAT(surveyed_map(map, {}).elements, SizeIs(map.elements.size()));
  const MapDashes unpainted{{kWholeLine}, {}, {kWholeLine}};
  EXPECT_THAT(surveyed_map(map, unpainted).elements, SizeIs(2));
}

// Nearly all dashed dividers of a town are painted. Their dashes cover the share given by the dash
// pattern.
TEST(SurveyedMap, ShowsTheDashesOfATown) {
  const World world = generate_world(kTuningSeedBase + 1);
  const MapDashes dashes = painted_dashes(world);
  double dashed_m = 0.0;
  double painted_m = 0.0;
  int dividers = 0;
  int unpainted = 0;
  for (size_t i = 0; i < dashes.size(); ++i) {
    const MapElement& element = world.map.elements[i];
    if (element.appearance != Appearance::kDashed) {
      EXPECT_TRUE(is_whole(dashes[i]));
      continue;
    }
    ++dividers;
    if (is_whole(dashes[i])) {
      ++unpainted;
      continue;
    }
    dashed_m += polyline_length(element.points);
    for (const Dash& dash : dashes[i]) painted_m += dash.to_m - dash.from_m;
  }
  ASSERT_GT(dividers, 5);
  EXPECT_LE(unpainted, dividers / 5);
  EXPECT_GT(painted_m, 0.2 * dashed_m);
  EXPECT_LT(painted_m, 0.55 * dashed_m);
}

}  // namespace
}  // namespace bevloc::sim
