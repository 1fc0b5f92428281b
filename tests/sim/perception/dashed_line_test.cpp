#include "sim/perception/dashed_line.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/perception/small_maps.h"

namespace bevloc::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(DashedLine, HasAPointAtEveryEndOfADash) {
  const std::array<Dash, 2> dashes{{{0.0, 2.0}, {5.0, 7.0}}};
  const DashedLine line = dashed_line(along_x(0.0, 10.0, 1.0), dashes);
  std::vector<double> x_m;
  for (const Eigen::Vector2d& point : line.points) x_m.push_back(point.x());
  EXPECT_THAT(x_m, ElementsAre(0.0, 2.0, 5.0, 7.0, 10.0));
  EXPECT_THAT(line.painted, ElementsAre(true, false, true, false));
}

TEST(DashedLine, ADashContinuesAroundACorner) {
  const std::array<Dash, 1> dashes{{{3.0, 6.0}}};
  const Polyline corner{{0.0, 0.0}, {4.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}};
  const DashedLine line = dashed_line(corner, dashes);
  ASSERT_EQ(line.points.size(), 5U);
  EXPECT_TRUE(line.points[1].isApprox(Eigen::Vector2d(3.0, 0.0)));
  EXPECT_TRUE(line.points[2].isApprox(Eigen::Vector2d(4.0, 0.0)));
  EXPECT_TRUE(line.points[3].isApprox(Eigen::Vector2d(4.0, 2.0)));
  EXPECT_THAT(line.painted, ElementsAre(false, true, true, false));
}

TEST(DashedLine, AContinuousLineIsUnchanged) {
  const Polyline points = arc({0.0, 0.0}, 8.0, 0.0, 1.0);
  const DashedLine line = dashed_line(points, {&kWholeLine, 1});
  ASSERT_EQ(line.points.size(), points.size());
  for (size_t i = 0; i < points.size(); ++i) EXPECT_TRUE(line.points[i].isApprox(points[i]));
  EXPECT_THAT(line.painted, testing::Each(true));
}

TEST(DashedLine, WithoutDashesNothingIsPainted) {
  EXPECT_THAT(dashed_line(along_x(0.0, 10.0, 1.0), {}).painted, ElementsAre(false));
}

TEST(PaintedStretches, AreAsLongAsPossible) {
  const auto stretches = painted_stretches({true, true, false, false, true});
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_EQ(stretches[0].first, 0U);
  EXPECT_EQ(stretches[0].last, 2U);
  EXPECT_EQ(stretches[1].first, 4U);
  EXPECT_EQ(stretches[1].last, 5U);
  EXPECT_THAT(painted_stretches({false, false}), IsEmpty());
}

}  // namespace
}  // namespace bevloc::sim
