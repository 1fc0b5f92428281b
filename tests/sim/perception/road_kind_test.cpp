#include "sim/perception/road_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/perception/small_maps.h"

namespace bevloc::sim {
namespace {

using ::testing::Eq;
using ::testing::Optional;

std::optional<RoadKind> kind_of(const HdMap& map, const Se2& pose = {},
                                const MapDashes& dashes = {}) {
  const MapIndex index(map);
  return road_kind(index, pose, dashes);
}

TEST(RoadKind, LinesThroughTheWholeBoxAreStraightSolid) {
  EXPECT_THAT(kind_of(open_road()), Optional(RoadKind::kStraightSolid));
  EXPECT_THAT(kind_of(open_road(), {3.0, 1.0, radians(184.0)}), Optional(RoadKind::kStraightSolid));
}

TEST(RoadKind, ElementsThatContinueOneAnotherAreNoStructure) {
  HdMap map = open_road();
  add_divider(map, along_x(-80.0, 5.0, 3.0));
  add_divider(map, along_x(5.02, 80.0, 3.02));
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kStraightSolid));
}

TEST(RoadKind, ACrossingMakesAStraightRoadStructured) {
  HdMap map = open_road();
  add_crossing(map, 12.0);
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kStraightStructured));
}

TEST(RoadKind, ALineEndMakesAStraightRoadStructured) {
  HdMap map = open_road();
  add_divider(map, along_x(-80.0, 10.0, 3.0));
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kStraightStructured));
}

TEST(RoadKind, DashesMakeAStraightRoadStructured) {
  const MapDashes dashes{{kWholeLine}, regular_dashes(), {kWholeLine}};
  EXPECT_THAT(kind_of(open_road(), {}, dashes), Optional(RoadKind::kStraightStructured));
}

TEST(RoadKind, ContinuousLinesAreStraightSolidInASurveyedMapToo) {
  const MapDashes dashes(3, {kWholeLine});
  EXPECT_THAT(kind_of(open_road(), {}, dashes), Optional(RoadKind::kStraightSolid));
}

TEST(RoadKind, DashesAtTheRimAreNeitherSolidNorStructured) {
  const MapDashes dashes{{kWholeLine}, {{0.0, 111.0}, {114.0, 160.0}}, {kWholeLine}};
  EXPECT_THAT(kind_of(open_road(), {}, dashes), Eq(std::nullopt));  // a gap 31 m ahead
}

TEST(RoadKind, DashesChangeNothingWhereTheRoadIsNotStraight) {
  HdMap map;
  const Eigen::Vector2d centre(0.0, 50.0);
  for (const double radius_m : {44.0, 50.0, 56.0}) add_kerb(map, arc(centre, radius_m, -2.7, -0.4));
  const MapDashes dashes{{kWholeLine}, regular_dashes(), {kWholeLine}};
  EXPECT_THAT(kind_of(map, {}, dashes), Optional(RoadKind::kCurve));
}

TEST(RoadKind, StructureAtTheRimIsNeitherSolidNorStructured) {
  HdMap map = open_road();
  add_crossing(map, 31.0);  // outside the box, but a box at the prior may show it
  EXPECT_THAT(kind_of(map), Eq(std::nullopt));
}

TEST(RoadKind, LinesThatBendTogetherAreACurve) {
  HdMap map;
  const Eigen::Vector2d centre(0.0, 50.0);
  for (const double radius_m : {44.0, 50.0, 56.0}) add_kerb(map, arc(centre, radius_m, -2.7, -0.4));
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kCurve));
}

TEST(RoadKind, AKerbThatTurnsACornerIsAJunction) {
  HdMap map;
  for (const double side : {1.0, -1.0}) {
    add_kerb(map, along_x(-80.0, 5.0, 6.0 * side));
    Polyline corner = arc({5.0, 12.0}, 6.0, -0.5 * std::numbers::pi, 0.0);
    for (Eigen::Vector2d& point : corner) point.y() *= side;
    add_kerb(map, corner);
    add_kerb(map, {{11.0, 12.0 * side}, {11.0, 60.0 * side}});
  }
  add_divider(map, along_x(-80.0, 0.0, 0.0));
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kJunction));
}

TEST(RoadKind, ACircularIslandIsARoundabout) {
  HdMap map;
  add_kerb(map, arc({15.0, 0.0}, 8.0, 0.0, 2.0 * std::numbers::pi));
  add_kerb(map, arc({15.0, 0.0}, 14.0, -2.5, 2.5));
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kMergeOrRoundabout));
}

TEST(RoadKind, TheRoundEndOfAMedianIsNoRoundabout) {
  HdMap map = open_road();
  Polyline median = arc({5.0, 0.0}, 1.0, -0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
  append(median, {{-80.0, 1.0}, {-80.0, -1.0}, median.front()});
  add_kerb(map, median);
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kStraightStructured));
}

TEST(RoadKind, AKerbThatShiftsByALaneIsAMerge) {
  HdMap map = open_road();
  map.elements.pop_back();
  Polyline taper{{-80.0, -6.0}};
  for (double x = -15.0; x <= 15.0; x += 1.0) {
    taper.emplace_back(x, -6.0 - 3.2 * smooth_step(-15.0, 15.0, x));
  }
  taper.emplace_back(80.0, -9.2);
  add_kerb(map, taper);
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kMergeOrRoundabout));
}

TEST(RoadKind, AParkingBayIsNoMerge) {
  HdMap map = open_road();
  map.elements.pop_back();
  add_kerb(map, {{-80.0, -6.0}, {-10.0, -6.0}, {-6.0, -8.4}, {80.0, -8.4}});
  EXPECT_THAT(kind_of(map), Optional(RoadKind::kStraightStructured));
}

TEST(RoadKind, TooLittleLineHasNoKind) {
  HdMap map;
  add_kerb(map, along_x(0.0, 20.0, 6.0));
  EXPECT_THAT(kind_of(map), Eq(std::nullopt));
  EXPECT_THAT(kind_of(open_road(), {0.0, 400.0, 0.0}), Eq(std::nullopt));
}

}  // namespace
}  // namespace bevloc::sim
