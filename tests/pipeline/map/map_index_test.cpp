#include "pipeline/map/map_index.h"

#include <gtest/gtest.h>

#include "sim/random.h"

namespace bevloc {
namespace {

MapElement element(ElementClass element_class, std::vector<Eigen::Vector2d> points) {
  return {element_class, Appearance::kUnknown, std::move(points)};
}

TEST(MapIndex, FindsSegmentsOfPolylinesAndClosingEdgesOfRings) {
  HdMap map;
  map.elements = {
      element(ElementClass::kLaneDivider, {{0, 0}, {10, 0}, {20, 0}}),
      element(ElementClass::kPedestrianCrossing, {{0, 5}, {4, 5}, {4, 9}, {0, 9}}),
  };
  const MapIndex index(map);
  std::vector<MapIndex::Segment> found;
  index.query({-1, -1}, {30, 30}, found);
  ASSERT_EQ(found.size(), 6U);
  EXPECT_EQ(found[1].element, 0U);
  EXPECT_EQ(found[1].first, 1U);
  EXPECT_EQ(found[5].element, 1U);
  EXPECT_EQ(found[5].first, 3U);

  index.query({-1, 6}, {1, 8}, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first, 3U);
}

TEST(MapIndex, FindsNothingInDegenerateElements) {
  HdMap map;
  map.elements = {element(ElementClass::kRoadBoundary, {}),
                  element(ElementClass::kRoadBoundary, {{1, 1}}),
                  element(ElementClass::kPedestrianCrossing, {})};
  const MapIndex index(map);
  std::vector<MapIndex::Segment> found(3);
  index.query({-10, -10}, {10, 10}, found);
  EXPECT_TRUE(found.empty());
}

TEST(MapIndex, AgreesWithAnExhaustiveSearch) {
  sim::Random random(7);
  HdMap map;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d start(random.uniform(-200, 200), random.uniform(-200, 200));
    map.elements.push_back(element(
        ElementClass::kRoadBoundary,
        {start, start + Eigen::Vector2d(random.uniform(-20, 20), random.uniform(-20, 20))}));
  }
  const MapIndex index(map);
  std::vector<MapIndex::Segment> found;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d low(random.uniform(-200, 200), random.uniform(-200, 200));
    const Eigen::Vector2d high = low + Eigen::Vector2d(random.uniform(1, 60), 30);
    index.query(low, high, found);
    size_t next = 0;
    for (uint32_t e = 0; e < map.elements.size(); ++e) {
      const auto& points = map.elements[e].points;
      const Eigen::Vector2d box_low = points[0].cwiseMin(points[1]);
      const Eigen::Vector2d box_high = points[0].cwiseMax(points[1]);
      const bool meets =
          (box_low.array() <= high.array()).all() && (box_high.array() >= low.array()).all();
      if (!meets) continue;
      ASSERT_LT(next, found.size());
      EXPECT_EQ(found[next++].element, e);
    }
    EXPECT_EQ(next, found.size());
  }
}

}  // namespace
}  // namespace bevloc
