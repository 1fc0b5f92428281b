#include "sim/perception/visible_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/bev_grid.h"
#include "tests/sim/perception/small_maps.h"

namespace bevloc::sim {
namespace {

std::vector<VisibleLine> lines_of(const HdMap& map, const Se2& pose = {}, double margin_m = 0.0) {
  const MapIndex index(map);
  return visible_lines(index, pose, margin_m);
}

TEST(VisibleLines, CutsALineAtTheGrownBox) {
  HdMap map;
  add_divider(map, along_x(-80.0, 80.0, 1.0));
  const auto lines = lines_of(map, {}, 3.0);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].begins);
  EXPECT_FALSE(lines[0].ends);
  EXPECT_NEAR(lines[0].points.front().x(), -33.0, 0.5);
  EXPECT_NEAR(lines[0].points.back().x(), 33.0, 0.5);
  for (size_t i = 1; i < lines[0].points.size(); ++i) {
    EXPECT_LE((lines[0].points[i] - lines[0].points[i - 1]).norm(), 0.5 + 1e-9);
  }
}

TEST(VisibleLines, AreInTheVehicleFrame) {
  HdMap map;
  add_divider(map, {{100.0, 60.0}, {100.0, 70.0}});  // runs north
  const auto lines = lines_of(map, {98.0, 50.0, radians(90.0)});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0].points.front().x(), 10.0, 1e-9);
  EXPECT_NEAR(lines[0].points.front().y(), -2.0, 1e-9);
  EXPECT_TRUE(lines[0].begins);
  EXPECT_TRUE(lines[0].ends);
}

TEST(VisibleLines, JoinElementsThatContinueOneAnotherEitherWayRound) {
  HdMap map;
  add_divider(map, along_x(-80.0, -5.0, 1.0));
  add_divider(map, along_x(20.0, -5.0, 1.05));  // the other way, a little off
  add_divider(map, along_x(20.0, 80.0, 1.0));
  const auto lines = lines_of(map);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].begins);
  EXPECT_FALSE(lines[0].ends);
}

TEST(VisibleLines, DoNotJoinAcrossGapsCornersOrClasses) {
  HdMap map;
  add_divider(map, along_x(-80.0, -5.0, 1.0));
  add_divider(map, along_x(-3.0, 10.0, 1.0));
  add_divider(map, {{10.0, 1.0}, {10.0, 9.0}});
  add_kerb(map, along_x(10.0, 80.0, 1.0));
  EXPECT_EQ(lines_of(map).size(), 4U);
}

TEST(VisibleLines, GiveTheTwoLongestEdgesOfACrossing) {
  HdMap map;
  add_crossing(map, 5.0);
  const auto lines = lines_of(map);
  ASSERT_EQ(lines.size(), 2U);
  for (const VisibleLine& line : lines) {
    EXPECT_EQ(line.element, 0U);
    EXPECT_NEAR((line.points.back() - line.points.front()).norm(), 12.0, 1e-9);
    EXPECT_NEAR(line.points.front().x(), line.points.back().x(), 1e-9);
  }
}

TEST(VisibleLines, JoinARingAtItsSeam) {
  HdMap map;
  add_kerb(map, arc({0.0, 0.0}, 8.0, 0.0, 2.0 * std::numbers::pi));
  const auto whole = lines_of(map);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_TRUE(whole[0].of_ring);
  EXPECT_FALSE(whole[0].begins);
  EXPECT_FALSE(whole[0].ends);
  // The seam, 8 m east of the centre, in the middle of the part that is in the box.
  const auto part = lines_of(map, {25.0, 0.0, 0.0});
  ASSERT_EQ(part.size(), 1U);
  EXPECT_TRUE(part[0].of_ring);
  EXPECT_FALSE(part[0].begins);
  EXPECT_FALSE(part[0].ends);
}

TEST(VisibleLines, AreNoneWhereThereIsNoMap) {
  EXPECT_TRUE(lines_of(straight_road(), {0.0, 500.0, 0.0}).empty());
}

}  // namespace
}  // namespace bevloc::sim
