#include "evaluation/drive/error_statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/pose_matchers.h"

namespace bevloc::evaluation {
namespace {

TEST(ErrorStatisticsTest, MeasuresEachAxis) {
  ErrorStatistics statistics;
  statistics.add({1.0, -0.5, radians(2.0)});
  statistics.add({-3.0, 0.5, radians(-4.0)});
  const PoseError error = statistics.summary();
  EXPECT_DOUBLE_EQ(error.longitudinal_m.mae, 2.0);
  EXPECT_DOUBLE_EQ(error.longitudinal_m.rmse, std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(error.longitudinal_m.p95, 3.0);
  EXPECT_DOUBLE_EQ(error.lateral_m.mae, 0.5);
  EXPECT_NEAR(error.yaw_deg.mae, 3.0, 1e-12);
}

TEST(ErrorStatisticsTest, IsZeroWithoutPoses) {
  EXPECT_EQ(ErrorStatistics().summary().lateral_m.p95, 0.0);
}

TEST(ErrorStatisticsTest, QuantilesUseNearestRank) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  EXPECT_EQ(quantile_of(values, 0.95), 95.0);
  EXPECT_EQ(quantile_of(values, 0.5), 50.0);
  EXPECT_EQ(quantile_of(values, 1.0), 100.0);
  EXPECT_EQ(quantile_of({7.0}, 0.99), 7.0);
}

TEST(ErrorStatisticsTest, ErrorIsInTheFrameOfTheTrueVehicle) {
  // Facing north, an estimate one metre further north is one metre too far ahead.
  const Se2 truth{10.0, 20.0, radians(90.0)};
  const Se2 error = pose_error(truth, {10.0, 21.0, radians(91.0)});
  EXPECT_THAT(error, test::PoseNear({1.0, 0.0, radians(1.0)}, 1e-12, radians(1e-12)));
}

}  // namespace
}  // namespace bevloc::evaluation
