#include "sim/world/path.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

Polyline circle_arc(double radius, double from, double to, int pieces) {
  Polyline line;
  for (int i = 0; i <= pieces; ++i) {
    line.emplace_back(radius * unit_vector(from + (to - from) * i / pieces));
  }
  return line;
}

TEST(Path, FindsPositionsAndContinuesStraightBeyondItsEnds) {
  const Path path({{0.0, 0.0}, {4.0, 0.0}, {4.0, 6.0}});
  EXPECT_DOUBLE_EQ(path.length_m(), 10.0);
  EXPECT_TRUE(path.position(2.0).isApprox(Eigen::Vector2d(2.0, 0.0)));
  EXPECT_TRUE(path.position(7.0).isApprox(Eigen::Vector2d(4.0, 3.0)));
  EXPECT_TRUE(path.position(-1.0).isApprox(Eigen::Vector2d(-1.0, 0.0)));
  EXPECT_TRUE(path.position(12.0).isApprox(Eigen::Vector2d(4.0, 8.0)));
}

TEST(Path, DropsRepeatedPoints) {
  const Path path({{0.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}});
  EXPECT_EQ(path.points().size(), 2U);
}

TEST(Path, ParallelOfAnArcIsAnArc) {
  const Path path(circle_arc(20.0, 0.0, 1.5, 40));
  const Polyline line = path.parallel(0.0, path.length_m(), 4.0);
  ASSERT_GT(line.size(), 2U);
  for (const Eigen::Vector2d& point : line) {
    EXPECT_NEAR(point.norm(), 24.0, 0.01);  // counter-clockwise, so the right side is outside
  }
}

TEST(Path, ParallelOfAStraightHasTwoPoints) {
  const Path path({{0.0, 0.0}, {3.0, 4.0}, {30.0, 40.0}});
  const Polyline line = path.parallel(5.0, 45.0, -2.0);
  ASSERT_EQ(line.size(), 2U);
  EXPECT_NEAR(polyline_length(line), 40.0, 1e-9);
}

TEST(SmoothTurn, RoundsACornerWithACircle) {
  const Polyline line = smooth_turn({-10.0, 0.0}, {1.0, 0.0}, {0.0, 10.0}, {0.0, 1.0});
  EXPECT_TRUE(line.front().isApprox(Eigen::Vector2d(-10.0, 0.0)));
  EXPECT_TRUE(line.back().isApprox(Eigen::Vector2d(0.0, 10.0)));
  for (const Eigen::Vector2d& point : line) {
    EXPECT_NEAR((point - Eigen::Vector2d(-10.0, 10.0)).norm(), 10.0, 0.01);
  }
}

TEST(SmoothTurn, KeepsTheEndDirectionsOfASideStep) {
  const Polyline line = smooth_turn({0.0, 0.0}, {1.0, 0.0}, {30.0, 3.0}, {1.0, 0.0});
  const Path path(line);
  EXPECT_NEAR(path.heading_rad(0.0), 0.0, 0.03);
  EXPECT_NEAR(path.heading_rad(path.length_m()), 0.0, 0.03);
  EXPECT_TRUE(line.back().isApprox(Eigen::Vector2d(30.0, 3.0)));
}

TEST(WithoutCollinear, KeepsCurvesAndDropsPointsOnStraights) {
  EXPECT_EQ(without_collinear({{0, 0}, {1, 0}, {2, 0}, {3, 0}}).size(), 2U);
  EXPECT_EQ(without_collinear(circle_arc(500.0, 0.0, 0.1, 50)).size(), 51U);
}

}  // namespace
}  // namespace bevloc::sim
