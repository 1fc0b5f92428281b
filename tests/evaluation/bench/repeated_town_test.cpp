#include "evaluation/bench/repeated_town.h"

#include <gtest/gtest.h>

#include "evaluation/bench/stage_work.h"
#include "pipeline/map/rasterizer.h"
#include "sim/random.h"
#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"

namespace bevloc::bench {
namespace {

/// Two straight roads of one kilometre, 5 km apart, each with a divider.
HdMap two_roads() {
  const auto line = [](ElementClass kind, double y) {
    return MapElement{kind, Appearance::kUnknown, {{0.0, y}, {500.0, y}, {1000.0, y}}};
  };
  HdMap map;
  for (const double y : {0.0, 5000.0}) {
    map.elements.push_back(line(ElementClass::kRoadBoundary, y));
    map.elements.push_back(line(ElementClass::kLaneDivider, y + 4.0));
    map.elements.push_back(line(ElementClass::kRoadBoundary, y + 8.0));
  }
  return map;
}

TEST(RepeatedTown, RoadIsHalfItsBoundaries) {
  EXPECT_DOUBLE_EQ(road_km(two_roads()), 2.0);
  EXPECT_DOUBLE_EQ(road_km(HdMap()), 0.0);
}

TEST(RepeatedTown, AShortMapHasTheNearestElements) {
  const HdMap map = repeated_town(two_roads(), {100.0, 5000.0}, 1.0);
  ASSERT_EQ(map.elements.size(), 3U);
  for (const MapElement& element : map.elements) EXPECT_GE(element.points[0].y(), 5000.0);
  EXPECT_DOUBLE_EQ(road_km(map), 1.0);
}

TEST(RepeatedTown, ALongMapHasCopiesAndKeepsTheFirstInPlace) {
  const HdMap town = two_roads();
  const HdMap map = repeated_town(town, {0.0, 0.0}, 14.0);
  EXPECT_DOUBLE_EQ(road_km(map), 14.0);
  ASSERT_EQ(map.elements.size(), 7 * town.elements.size());
  EXPECT_EQ(map.elements[0].points[2], town.elements[0].points[2]);
  EXPECT_EQ(map.elements[6].points[0].x(), 1100.0);
  EXPECT_EQ(map.elements[18].points[0].y(), 5108.0);
}

TEST(RepeatedTown, AnEmptyMapStaysEmpty) {
  EXPECT_TRUE(repeated_town(HdMap(), {0.0, 0.0}, 10.0).elements.empty());
}

/// The sweep relies on this: maps of all lengths need the same drawing.
TEST(RepeatedTown, LooksTheSameAroundThePlace) {
  const sim::World world = sim::generate_world(7);
  sim::Random random(1);
  const Se2 place = sim::random_pose_on_road(world, random);
  std::vector<std::vector<uint8_t>> rasters;
  std::vector<size_t> segments;
  for (const double km : {1.0, 10.0, 100.0}) {
    const HdMap map = repeated_town(world.map, place.translation(), km);
    const MapIndex index(map);
    rasters.emplace_back(kRasterSize);
    MapRasterizer(index).draw(place, rasters.back());
    std::vector<MapIndex::Segment> found;
    const Surroundings around = surroundings_of(place);
    index.query(around.min_corner, around.max_corner, found);
    segments.push_back(found.size());
  }
  EXPECT_EQ(rasters[0], rasters[1]);
  EXPECT_EQ(rasters[1], rasters[2]);
  EXPECT_GT(segments[0], 0U);
  EXPECT_EQ(segments, std::vector<size_t>(3, segments[0]));
}

}  // namespace
}  // namespace bevloc::bench
