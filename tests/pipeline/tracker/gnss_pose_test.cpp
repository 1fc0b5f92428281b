#include "pipeline/tracker/gnss_pose.h"

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

using Yaw = GnssSample::Yaw;

/// An antenna 2 m in front of the rear axle and 1 m to its left.
GnssSample antenna_at(double east_m, double north_m) {
  return {.east_m = east_m,
          .north_m = north_m,
          .sigma_east_m = 1.0,
          .sigma_north_m = 2.0,
          .antenna = GnssSample::Antenna{2.0, 1.0}};
}

TEST(AtRearAxle, TurnsTheLeverWithTheVehicle) {
  const GnssSample north = at_rear_axle(antenna_at(10.0, 20.0), Yaw{radians(90.0), 0.0});
  EXPECT_NEAR(north.east_m, 11.0, 1e-12);
  EXPECT_NEAR(north.north_m, 18.0, 1e-12);
  EXPECT_NEAR(north.sigma_east_m, 1.0, 1e-12);
  EXPECT_FALSE(north.antenna);
}

TEST(AtRearAxle, TakesTheYawThatIsMoreCertain) {
  GnssSample sample = antenna_at(0.0, 0.0);
  sample.yaw = Yaw{radians(180.0), 0.1};
  const GnssSample own = at_rear_axle(sample, Yaw{0.0, 0.2});
  EXPECT_NEAR(own.east_m, 2.0, 1e-12);
  EXPECT_NEAR(own.sigma_north_m, std::hypot(2.0, 0.1 * std::sqrt(5.0)), 1e-12);
  EXPECT_NEAR(at_rear_axle(sample, Yaw{0.0, 0.05}).east_m, -2.0, 1e-12);
}

TEST(AtRearAxle, WithoutAYawTheDistanceIsUncertainty) {
  const GnssSample sample = at_rear_axle(antenna_at(3.0, 4.0), std::nullopt);
  EXPECT_EQ(sample.east_m, 3.0);
  EXPECT_NEAR(sample.sigma_east_m, std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(sample.sigma_north_m, 3.0, 1e-12);
}

TEST(AtRearAxle, LeavesAPositionOfTheRearAxleAlone) {
  GnssSample sample = antenna_at(3.0, 4.0);
  sample.antenna.reset();
  EXPECT_EQ(at_rear_axle(sample, Yaw{1.0, 0.1}).east_m, 3.0);
}

TEST(GnssPose, AYawWithALargeSigmaIsUnknown) {
  GnssSample sample = antenna_at(3.0, 4.0);
  sample.yaw = Yaw{2.0, 0.9};
  EXPECT_TRUE(gnss_pose(sample).has_yaw);
  sample.yaw = Yaw{2.0, radians(360.0)};  // what a receiver may send for "unknown"
  const GnssPose pose = gnss_pose(sample);
  EXPECT_FALSE(pose.has_yaw);
  EXPECT_DOUBLE_EQ(pose.yaw_sigma_rad, std::numbers::pi);
}

}  // namespace
}  // namespace bevloc
