#include "sim/samples/map_habits.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "sim/world/path.h"
#include "tests/sim/straight_road.h"

namespace bevloc::sim {
namespace {

constexpr uint64_t kHabitSeed = 5;
std::vector<Polyline> lines_of(const HdMap& map, ElementClass element_class) {
  std::vector<Polyline> lines;
  for (const MapElement& element : map.elements) {
    if (element.element_class == element_class) lines.push_back(element.points);
  }
  return lines;
}

std::vector<Polyline> dividers(const MapHabits& habits, uint64_t seed = kHabitSeed) {
  return lines_of(with_habits(straight_road(), habits, seed), ElementClass::kLaneDivider);
}

std::vector<Polyline> boundaries(const MapHabits& habits, uint64_t seed = kHabitSeed) {
  return lines_of(with_habits(straight_road(), habits, seed), ElementClass::kRoadBoundary);
}

TEST(MapHabits, WithoutHabitsTheMapIsUnchanged) {
  const HdMap same = with_habits(straight_road(), {}, kHabitSeed);
  ASSERT_EQ(same.elements.size(), straight_road().elements.size());
  for (size_t i = 0; i < same.elements.size(); ++i) {
    EXPECT_EQ(same.elements[i].points, straight_road().elements[i].points);
  }
}

TEST(MapHabits, DividersEndBeforeThePaint) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto lines = dividers({.short_divider = 1.0}, seed);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_GE(lines[0].front().x(), 5.0);
    EXPECT_LE(lines[0].front().x(), 30.0);
    EXPECT_LE(lines[0].back().x(), kLength_m - 5.0);
    EXPECT_GE(lines[0].back().x(), kLength_m - 30.0);
  }
}

TEST(MapHabits, DividersGoOnBeyondThePaint) {
  const auto lines = dividers({.long_divider = 1.0});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_LE(lines[0].front().x(), -5.0);
  EXPECT_GE(lines[0].back().x(), kLength_m + 5.0);
  EXPECT_EQ(lines[0].front().y(), 0.0);
}

TEST(MapHabits, DividersHaveAGap) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto lines = dividers({.broken_divider = 1.0}, seed);
    double drawn_m = 0.0;
    for (const Polyline& line : lines) drawn_m += polyline_length(line);
    EXPECT_LE(drawn_m, kLength_m - 4.9) << "half of the shortest gap, at an end";
    EXPECT_GE(drawn_m, kLength_m - 43.0);
  }
}

TEST(MapHabits, BoundariesLieInsideTheKerb) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto lines = boundaries({.inner_boundary = 1.0}, seed);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_GE(lines[0].front().y(), -3.9);
    EXPECT_LE(lines[0].front().y(), -3.3);
  }
}

TEST(MapHabits, BoundariesGoOnAcrossMouths) {
  const auto lines = boundaries({.closed_mouth = 1.0});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_LE(lines[0].front().x(), -5.0);
  EXPECT_GE(lines[0].back().x(), kLength_m + 5.0);
}

TEST(MapHabits, BoundariesHaveASecondLineOutside) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto lines = boundaries({.double_boundary = 1.0}, seed);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[0].front().y(), -4.0);
    EXPECT_LE(lines[1].front().y(), -4.5);
    EXPECT_GE(lines[1].front().y(), -8.0);
  }
}

TEST(MapHabits, SharesAreKeptAndCrossingsStay) {
  const MapHabits habits{.short_divider = 0.5};
  int shorter = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const auto lines = dividers(habits, seed);
    shorter += lines[0].front().x() > 0.0 ? 1 : 0;
    EXPECT_EQ(
        lines_of(with_habits(straight_road(), habits, seed), ElementClass::kPedestrianCrossing),
        lines_of(straight_road(), ElementClass::kPedestrianCrossing));
  }
  EXPECT_GT(shorter, 70);
  EXPECT_LT(shorter, 130);
}

TEST(MapHabits, AFactorMultipliesTheSharesUpToOne) {
  const MapHabits stronger = scaled({.short_divider = 0.4, .inner_boundary = 0.9}, 1.5);
  EXPECT_DOUBLE_EQ(stronger.short_divider, 0.6);
  EXPECT_DOUBLE_EQ(stronger.inner_boundary, 1.0);
  EXPECT_EQ(scaled(stronger, 0.0), MapHabits());
}

}  // namespace
}  // namespace bevloc::sim
