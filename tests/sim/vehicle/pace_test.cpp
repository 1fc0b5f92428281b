#include "sim/vehicle/pace.h"

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

TEST(Pace, WithoutPointsIsThePlan) {
  const Pace::Moment moment = Pace().at(12.3);
  EXPECT_EQ(moment.planned_s, 12.3);
  EXPECT_EQ(moment.pace, 1.0);
  EXPECT_EQ(moment.change_per_s, 0.0);
}

TEST(Pace, OnePointHoldsAllTheTime) {
  const Pace half({{5.0, 0.5}});
  for (const double time_s : {0.0, 4.0, 5.0, 8.0}) {
    EXPECT_DOUBLE_EQ(half.at(time_s).planned_s, 0.5 * time_s) << time_s;
    EXPECT_EQ(half.at(time_s).pace, 0.5) << time_s;
  }
}

TEST(Pace, IsLinearBetweenPoints) {
  const Pace pace({{2.0, 0.0}, {6.0, 1.0}});
  EXPECT_EQ(pace.at(1.9).pace, 0.0);
  EXPECT_DOUBLE_EQ(pace.at(5.0).pace, 0.75);
  EXPECT_DOUBLE_EQ(pace.at(5.0).change_per_s, 0.25);
  EXPECT_DOUBLE_EQ(pace.at(5.0).planned_s, 0.5 * 3.0 * 0.75);
  EXPECT_EQ(pace.at(6.0).pace, 1.0);
  EXPECT_DOUBLE_EQ(pace.at(10.0).planned_s, 6.0);
  EXPECT_EQ(pace.at(10.0).change_per_s, 0.0);
}

TEST(Pace, ThePlannedTimeIsTheSumOfThePace) {
  const Pace pace({{3.0, 1.0}, {5.0, 0.0}, {6.0, -0.4}, {9.0, -0.2}, {11.0, 1.0}});
  constexpr double kStep_s = 0.001;
  double planned_s = 0.0;
  for (int i = 0; i < 15'000; ++i) {
    planned_s += kStep_s * pace.at((i + 0.5) * kStep_s).pace;
    ASSERT_NEAR(pace.at((i + 1) * kStep_s).planned_s, planned_s, 1e-5) << i;
  }
}

TEST(Pace, TellsHowFarBackTheVehicleComes) {
  EXPECT_EQ(Pace().earliest_planned_s(100.0), 0.0);
  const Pace there_and_back({{0.0, 0.0}, {2.0, -0.5}, {4.0, 0.5}, {8.0, 1.0}});
  EXPECT_DOUBLE_EQ(there_and_back.earliest_planned_s(100.0), -0.75) << "the pace is 0 at 3 s";
  EXPECT_DOUBLE_EQ(there_and_back.earliest_planned_s(2.0), -0.5);
  const Pace slower({{0.0, -1.0}, {2.0, -0.5}});
  EXPECT_DOUBLE_EQ(slower.earliest_planned_s(4.0), -2.5) << "it never stops";
  const Pace later({{4.0, 1.0}, {5.0, -1.0}, {6.0, -1.0}, {7.0, 0.0}});
  EXPECT_EQ(later.earliest_planned_s(100.0), 0.0) << "the vehicle has driven farther before";
}

}  // namespace
}  // namespace bevloc::sim
