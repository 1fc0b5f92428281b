#include "can/vehicle/wheel_fusion.h"

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

constexpr double kTrack_m = 1.6;
constexpr double kWheelbase_m = 2.7;
constexpr double kTurning_radps = 0.3;
constexpr WheelPlace kPlaces[] = {WheelPlace::kRearLeft, WheelPlace::kRearRight,
                                  WheelPlace::kFrontLeft, WheelPlace::kFrontRight};

TEST(WheelFusionTest, TakesTwoRearWheelsAsTheyAre) {
  WheelFusion fusion(kTrack_m, 0.0, kTurning_radps);
  fusion.add(WheelPlace::kRearLeft, 9.5);
  fusion.add(WheelPlace::kRearRight, 10.5);
  const auto speeds = fusion.speeds();
  ASSERT_TRUE(speeds);
  EXPECT_NEAR(speeds->left_mps, 9.5, 1e-12);
  EXPECT_NEAR(speeds->right_mps, 10.5, 1e-12);
  EXPECT_TRUE(speeds->both_sides);
}

TEST(WheelFusionTest, TranslatesFrontWheelsToTheRearAxle) {
  const WheelFusion axle(kTrack_m, kWheelbase_m, kTurning_radps);
  WheelFusion fusion = axle;
  for (const WheelPlace place : kPlaces) fusion.add(place, axle.wheel_speed(place, 8.0));
  EXPECT_GT(axle.wheel_speed(WheelPlace::kFrontLeft, 8.0),
            axle.wheel_speed(WheelPlace::kRearLeft, 8.0));
  const auto speeds = fusion.speeds();
  ASSERT_TRUE(speeds);
  EXPECT_NEAR(speeds->left_mps, 8.0 - 0.5 * kTrack_m * kTurning_radps, 1e-9);
  EXPECT_NEAR(speeds->right_mps, 8.0 + 0.5 * kTrack_m * kTurning_radps, 1e-9);
}

TEST(WheelFusionTest, LeavesOutASlippingWheel) {
  for (const WheelPlace slipping : kPlaces) {
    const WheelFusion axle(kTrack_m, kWheelbase_m, kTurning_radps);
    WheelFusion fusion = axle;
    for (const WheelPlace place : kPlaces) {
      fusion.add(place, axle.wheel_speed(place, 8.0) + (place == slipping ? 6.0 : 0.0));
    }
    const auto speeds = fusion.speeds();
    ASSERT_TRUE(speeds);
    EXPECT_NEAR(speeds->left_mps, 8.0 - 0.5 * kTrack_m * kTurning_radps, 1e-9);
    EXPECT_NEAR(speeds->right_mps, 8.0 + 0.5 * kTrack_m * kTurning_radps, 1e-9);
  }
}

TEST(WheelFusionTest, SaysThatTheOnlyWheelOfASideSlips) {
  WheelFusion fusion(kTrack_m, kWheelbase_m, 0.0);
  fusion.add(WheelPlace::kRearLeft, 8.0);
  fusion.add(WheelPlace::kFrontLeft, 8.0);
  fusion.add(WheelPlace::kRearRight, 14.0);
  const auto speeds = fusion.speeds();
  ASSERT_TRUE(speeds);
  EXPECT_NEAR(speeds->right_mps, 8.0, 1e-12);
  EXPECT_FALSE(speeds->both_sides);
}

TEST(WheelFusionTest, RefusesWheelsThatAllContradict) {
  WheelFusion fusion(kTrack_m, kWheelbase_m, 0.0);
  fusion.add(WheelPlace::kRearLeft, 0.0);
  fusion.add(WheelPlace::kRearRight, 3.0);
  fusion.add(WheelPlace::kFrontLeft, 10.0);
  fusion.add(WheelPlace::kFrontRight, 20.0);
  EXPECT_FALSE(fusion.speeds());
  EXPECT_FALSE(WheelFusion(kTrack_m, 0.0, 0.0).speeds());
}

TEST(WheelFusionTest, TakesTheSpeedOfTheVehicle) {
  WheelFusion fusion(kTrack_m, 0.0, kTurning_radps);
  fusion.add(WheelPlace::kVehicle, 5.0);
  const auto speeds = fusion.speeds();
  ASSERT_TRUE(speeds);
  EXPECT_NEAR(0.5 * (speeds->left_mps + speeds->right_mps), 5.0, 1e-12);
  EXPECT_NEAR(speeds->right_mps - speeds->left_mps, kTrack_m * kTurning_radps, 1e-12);
  EXPECT_FALSE(speeds->both_sides);
}

}  // namespace
}  // namespace bevloc::can
