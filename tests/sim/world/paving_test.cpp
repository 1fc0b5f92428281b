#include "sim/world/paving.h"

#include <gtest/gtest.h>

#include "sim/world/path.h"
#include "tests/sim/geometry.h"

namespace bevloc::sim {
namespace {

constexpr double kLength_m = 60.0;

Polyline straight(double y) {
  return {{0.0, y}, {kLength_m, y}};
}

Lane lane_between(double left_y, double right_y) {
  Lane lane;
  lane.left = straight(left_y);
  lane.right = straight(right_y);
  lane.centerline = straight(0.5 * (left_y + right_y));
  return lane;
}

HdMap with_boundary(double y) {
  HdMap map;
  map.lanes = {lane_between(0.0, -3.5)};
  map.elements = {{ElementClass::kRoadBoundary, Appearance::kKerb, straight(y)}};
  return map;
}

bool is_paved(const HdMap& map, const Eigen::Vector2d& point) {
  for (const Ring& ring : paved_rings(map)) {
    if (is_in_ring(point, ring)) return true;
  }
  return false;
}

TEST(Paving, AsphaltEndsAtTheBoundary) {
  for (const double boundary_m : {-3.5, -3.9, -6.0, -9.0}) {
    const HdMap map = with_boundary(boundary_m);
    EXPECT_TRUE(is_paved(map, {30.2, boundary_m + 0.05})) << boundary_m;
    EXPECT_FALSE(is_paved(map, {30.2, boundary_m - 0.05})) << boundary_m;
  }
}

TEST(Paving, WithoutABoundaryNearbyThereIsAShoulder) {
  const HdMap map = with_boundary(-12.0);
  EXPECT_TRUE(is_paved(map, {30.2, -3.75}));
  EXPECT_FALSE(is_paved(map, {30.2, -3.85}));
}

TEST(Paving, TheGapBetweenTwoLanesIsPaved) {
  HdMap map = with_boundary(-3.5);
  map.lanes.push_back(lane_between(6.0, 2.5));
  EXPECT_TRUE(is_paved(map, {30.2, 1.2}));
}

TEST(Paving, AnIslandBetweenTwoLanesIsNotPaved) {
  HdMap map = with_boundary(-3.5);
  map.lanes.push_back(lane_between(6.0, 2.5));
  map.elements.push_back({ElementClass::kRoadBoundary, Appearance::kKerb, straight(0.5)});
  map.elements.push_back({ElementClass::kRoadBoundary, Appearance::kKerb, straight(2.0)});
  EXPECT_TRUE(is_paved(map, {30.2, 0.3}));
  EXPECT_FALSE(is_paved(map, {30.2, 1.2}));
  EXPECT_TRUE(is_paved(map, {30.2, 2.3}));
}

TEST(Paving, AMapWithoutLanesHasNoPavedGround) {
  HdMap map = with_boundary(-3.5);
  map.lanes.clear();
  EXPECT_TRUE(paved_rings(map).empty());
}

}  // namespace
}  // namespace bevloc::sim
