#include <algorithm>

#include <gtest/gtest.h>

#include "sim/world/world_generator.h"
#include "tests/sim/geometry.h"

namespace bevloc::sim {
namespace {

/// Two lanes of one road, a divider, a kerb, a hedge and a crossing.
HdMap small_map() {
  HdMap map;
  const auto line = [](double y) { return Polyline{{0.0, y}, {60.0, y}}; };
  map.elements = {
      {ElementClass::kLaneDivider, Appearance::kDashed, line(0.0)},
      {ElementClass::kRoadBoundary, Appearance::kKerb, line(-3.5)},
      {ElementClass::kRoadBoundary, Appearance::kHedge, line(3.5)},
      {ElementClass::kPedestrianCrossing,
       Appearance::kZebra,
       {{20.0, -3.5}, {24.0, -3.5}, {24.0, 3.5}, {20.0, 3.5}}},
  };
  Lane forward;
  forward.left = line(0.0);
  forward.right = line(-3.5);
  forward.centerline = line(-1.75);
  Lane backward;
  backward.left = reversed(line(0.0));
  backward.right = reversed(line(3.5));
  backward.centerline = reversed(line(1.75));
  map.lanes = {forward, backward};
  return map;
}

TEST(WorldFromMap, DoesNotChangeTheMap) {
  const HdMap map = small_map();
  const World world = world_from_map(map, 3);
  ASSERT_EQ(world.map.elements.size(), map.elements.size());
  for (size_t i = 0; i < map.elements.size(); ++i) {
    EXPECT_EQ(world.map.elements[i].points, map.elements[i].points);
  }
}

TEST(WorldFromMap, PaintAndWallsFollowTheAppearance) {
  const World world = world_from_map(small_map(), 3);
  ASSERT_EQ(world.paint_lines.size(), 1U);
  EXPECT_GT(world.paint_lines.front().dash_m, 0.0);
  const auto stands = [&](WallTexture texture, double y) {
    return std::any_of(world.walls.begin(), world.walls.end(), [&](const Wall& wall) {
      return wall.texture == texture && std::abs(wall.base.front().y() - y) < 1e-9;
    });
  };
  EXPECT_TRUE(stands(WallTexture::kHedge, 3.5));
  EXPECT_TRUE(stands(WallTexture::kKerbPlain, -3.5) || stands(WallTexture::kKerbStriped, -3.5) ||
              stands(WallTexture::kKerbPainted, -3.5));
}

TEST(WorldFromMap, ZebraBarsLieInTheirCrossing) {
  const World world = world_from_map(small_map(), 3);
  ASSERT_GE(world.paint_areas.size(), 4U);
  for (const PaintArea& bar : world.paint_areas) {
    for (const Eigen::Vector2d& p : bar.ring) {
      EXPECT_GE(p.x(), 20.0 - 1e-6);
      EXPECT_LE(p.x(), 24.0 + 1e-6);
      EXPECT_LE(std::abs(p.y()), 3.5 + 1e-6);
    }
    // The bars run along the road; pedestrians walk across them.
    EXPECT_NEAR(std::abs(bar.ring[2].x() - bar.ring[1].x()), 4.0, 1e-6);
  }
}

TEST(WorldFromMap, NoSceneryStandsOnALane) {
  const World world = world_from_map(small_map(), 11);
  for (const Wall& wall : world.walls) {
    for (const Lane& lane : world.map.lanes) EXPECT_FALSE(lines_cross(wall.base, lane.centerline));
  }
  for (const Post& post : world.posts) EXPECT_GT(std::abs(post.position.y()), 3.0);
}

TEST(WorldFromMap, IsTheSameEveryTime) {
  const World a = world_from_map(small_map(), 5);
  const World b = world_from_map(small_map(), 5);
  ASSERT_EQ(a.walls.size(), b.walls.size());
  for (size_t i = 0; i < a.walls.size(); ++i) EXPECT_EQ(a.walls[i].base, b.walls[i].base);
}

TEST(WorldFromMap, AcceptsMapsWithoutLanesAndDegenerateLines) {
  HdMap map = small_map();
  map.lanes.clear();
  map.elements.push_back({ElementClass::kLaneDivider, Appearance::kUnknown, {{5.0, 5.0}}});
  map.elements.push_back(
      {ElementClass::kRoadBoundary, Appearance::kUnknown, {{5.0, 5.0}, {5.0, 5.0}}});
  const World world = world_from_map(map, 1);
  EXPECT_TRUE(world.traffic.empty());
  EXPECT_FALSE(world.surfaces.empty());
  EXPECT_TRUE(world_from_map(HdMap{}, 1).surfaces.empty());
}

}  // namespace
}  // namespace bevloc::sim
