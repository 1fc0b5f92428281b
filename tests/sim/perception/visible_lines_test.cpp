#include "sim/perception/visible_lines.h"

#include <cmath>

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

TEST(VisibleLines, JoinElementsThatContinueEachOtherInEitherDirection) {
  HdMap map;
  add_divider(map, along_x(-80.0, -5.0, 1.0));
  add_divider(map, along_x(20.0, -5.0, 1.05));  // in the opposite direction, slightly off
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
  // From here the seam, 8 m east of the ring's centre, lies in the middle of the visible part.
  const auto part = lines_of(map, {25.0, 0.0, 0.0});
  ASSERT_EQ(part.size(), 1U);
  EXPECT_TRUE(part[0].of_ring);
  EXPECT_FALSE(part[0].begins);
  EXPECT_FALSE(part[0].ends);
}

TEST(VisibleLines, ADashedLineIsOneLineWithGaps) {
  HdMap map;
  add_divider(map, along_x(-80.0, 80.0, 1.0));
  const MapIndex index(map);
  const auto lines = visible_lines(index, {0.0, 0.0, radians(180.0)}, 0.0, {regular_dashes()});
  ASSERT_EQ(lines.size(), 1U);
  ASSERT_EQ(lines[0].painted.size() + 1, lines[0].points.size());
  const auto stretches = painted_stretches(lines[0].painted);
  ASSERT_EQ(stretches.size(), 8U);  // every 8 m from -32 to 27 m; the first begins outside the box
  for (size_t k = 1; k + 1 < stretches.size(); ++k) {
    const double from_m = -32.0 + 8.0 * static_cast<double>(k);
    EXPECT_NEAR(lines[0].points[stretches[k].first].x(), -from_m, 1e-9);
    EXPECT_NEAR(lines[0].points[stretches[k].last].x(), -from_m - 3.0, 1e-9);
  }
}

// The two elements run towards each other, so one of them and its dashes must be reversed.
TEST(VisibleLines, KeepTheirDashesWhenJoined) {
  HdMap map;
  add_divider(map, along_x(-80.0, 0.0, 1.0));
  add_divider(map, along_x(80.0, 0.0, 1.0));
  const MapIndex index(map);
  const MapDashes dashes{{{60.0, 70.0}}, {{55.0, 75.0}}};
  const auto lines = visible_lines(index, {}, 0.0, dashes);
  ASSERT_EQ(lines.size(), 1U);
  double painted_before_m = 0.0;
  double painted_beyond_m = 0.0;
  for (const PointRange& stretch : painted_stretches(lines[0].painted)) {
    const Eigen::Vector2d& first = lines[0].points[stretch.first];
    const Eigen::Vector2d& last = lines[0].points[stretch.last];
    (first.x() < 0.0 ? painted_before_m : painted_beyond_m) += (last - first).norm();
    EXPECT_GT(std::abs(first.x()), 4.9);
  }
  EXPECT_NEAR(painted_before_m, 10.0, 1e-9);
  EXPECT_NEAR(painted_beyond_m, 20.0, 1e-9);
}

TEST(VisibleLines, AreEmptyOutsideTheMap) {
  EXPECT_TRUE(lines_of(open_road(), {0.0, 500.0, 0.0}).empty());
}

}  // namespace
}  // namespace bevloc::sim
