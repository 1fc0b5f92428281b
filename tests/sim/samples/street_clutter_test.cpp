#include "sim/samples/street_clutter.h"

#include <algorithm>

#include <gmock/gmock.h>

#include "sim/world/world_digest.h"
#include "tests/sim/straight_road.h"

namespace bevloc::sim {
namespace {

constexpr uint64_t kClutterSeed = 3;

/// The boundary lies at y = -4 m, the road north of it.
World road_world() {
  World world;
  world.map = straight_road();
  world.paint_lines.push_back(
      {.points = straight(0.0), .width_m = 0.12, .dash_m = 3.0, .gap_m = 6.0});
  return world;
}

World with(const StreetClutter& clutter, uint64_t seed = kClutterSeed) {
  World world = road_world();
  add_clutter(clutter, seed, world);
  return world;
}

TEST(StreetClutterTest, WithoutClutterTheWorldIsUnchanged) {
  EXPECT_EQ(digest_of(with({})), digest_of(road_world()));
  EXPECT_EQ(scaled({.box = 0.5}, 0.0), StreetClutter{});
}

TEST(StreetClutterTest, DependsOnTheSeedAlone) {
  const StreetClutter all{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 5.0};
  EXPECT_EQ(digest_of(with(all, 4)), digest_of(with(all, 4)));
  EXPECT_NE(digest_of(with(all, 4)), digest_of(with(all, 5)));
}

TEST(StreetClutterTest, LinesAtTheKerbLieOnTheRoad) {
  const World world = with({.kerb_line = 1.0});
  ASSERT_GE(world.paint_lines.size(), 2U);
  for (size_t i = 1; i < world.paint_lines.size(); ++i) {
    for (const Eigen::Vector2d& point : world.paint_lines[i].points) {
      EXPECT_GT(point.y(), -4.0);
      EXPECT_LT(point.y(), -3.0);
    }
  }
}

TEST(StreetClutterTest, BollardsAndRailingsStandOutside) {
  const World world = with({.bollards = 1.0, .railing = 1.0});
  EXPECT_GT(world.posts.size(), 20U);
  for (const Post& post : world.posts) EXPECT_LT(post.position.y(), -4.0);
  ASSERT_EQ(world.walls.size(), 1U);
  for (const Eigen::Vector2d& point : world.walls[0].base) EXPECT_LT(point.y(), -4.0);
}

TEST(StreetClutterTest, StudsReplaceTheDashesInTheirPlace) {
  const World world = with({.studs = 1.0});
  ASSERT_EQ(world.paint_lines.size(), 1U);
  EXPECT_EQ(world.paint_lines[0].points, straight(0.0));
  EXPECT_LT(world.paint_lines[0].dash_m, 0.2);
}

TEST(StreetClutterTest, LinesRunAlongTheLongEdgesOfACrossing) {
  const World world = with({.crossing_edges = 1.0});
  ASSERT_EQ(world.paint_lines.size(), 3U);
  for (size_t i = 1; i < 3; ++i) {
    const Polyline& points = world.paint_lines[i].points;
    EXPECT_NEAR((points[1] - points[0]).norm(), 4.0, 1e-9);
  }
  EXPECT_NE(world.paint_lines[1].points, world.paint_lines[2].points);
}

TEST(StreetClutterTest, BoxesAndWorksStayInTheLane) {
  const World world = with({.box = 1.0, .works = 1.0});
  EXPECT_GT(world.paint_lines.size(), 4U);
  EXPECT_GE(world.posts.size(), 1U);
  EXPECT_EQ(world.walls.size(), 1U);
  const auto in_lane = [](const Eigen::Vector2d& point) {
    return std::abs(point.y() + 1.75) < 1.7;
  };
  for (size_t i = 1; i < world.paint_lines.size(); ++i) {
    EXPECT_TRUE(std::ranges::all_of(world.paint_lines[i].points, in_lane));
  }
  for (const Post& post : world.posts) EXPECT_TRUE(in_lane(post.position));
}

TEST(StreetClutterTest, ShadowsLieOnTheRoadAndLeaveSomeLight) {
  int with_shade = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    for (const Shade& shade : with({.shadow = 1.0}, seed).shades) {
      ++with_shade;
      EXPECT_GT(shade.light, 0.1F);
      EXPECT_LT(shade.light, 0.8F);
      EXPECT_GE(shade.ring.size(), 4U);
    }
  }
  EXPECT_GE(with_shade, 10);
}

TEST(StreetClutterTest, PeopleStandOnTheGround) {
  const World world = with({.people_per_100m = 6.0});
  ASSERT_EQ(world.posts.size() % 3, 0U);
  EXPECT_GE(world.posts.size(), 9U);
  EXPECT_EQ(std::ranges::count(world.posts, 0.0, &Post::bottom_m),
            static_cast<std::ptrdiff_t>(world.posts.size() / 3));
}

}  // namespace
}  // namespace bevloc::sim
