#include "pipeline/tracker/pose_trail.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

using std::chrono::milliseconds;

TrackedPose pose_at(int ms, double x_m, double yaw_rad = 0.0) {
  TrackedPose pose;
  pose.time = Time(milliseconds(ms));
  pose.map_from_vehicle = {x_m, 0.0, yaw_rad};
  pose.speed_mps = 10.0;
  return pose;
}

TEST(PoseTrailTest, IsEmptyAtFirst) {
  const PoseTrail trail;
  EXPECT_FALSE(trail.at(Time(milliseconds(0))));
}

TEST(PoseTrailTest, InterpolatesYawAcross180Degrees) {
  PoseTrail trail;
  trail.add(pose_at(0, 0.0, radians(179.0)));
  trail.add(pose_at(10, 0.0, radians(-179.0)));
  const auto pose = trail.at(Time(milliseconds(5)));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(std::abs(wrap_angle(pose->yaw_rad)), radians(180.0), 1e-9);
}

TEST(PoseTrailTest, ExtrapolatesUpToItsReach) {
  PoseTrail trail;
  TrackedPose pose = pose_at(0, 5.0);
  pose.yaw_rate_radps = 0.5;
  trail.add(pose);
  const auto later = trail.at(Time(milliseconds(100)));
  ASSERT_TRUE(later);
  EXPECT_THAT(*later, test::PoseNear({5.0 + std::cos(0.025), std::sin(0.025), 0.05}, 1e-9, 1e-12));
  EXPECT_FALSE(trail.at(Time(PoseTrail::kReach + milliseconds(1))));
}

TEST(PoseTrailTest, ReturnsNothingBeforeItsOldestPose) {
  PoseTrail trail;
  for (int i = 0; i < 1000; ++i) trail.add(pose_at(10 * i, 0.1 * i));
  EXPECT_FALSE(trail.at(Time(milliseconds(10))));
  const auto recent = trail.at(Time(milliseconds(9905)));
  ASSERT_TRUE(recent);
  EXPECT_NEAR(recent->x_m, 99.05, 1e-9);
}

TEST(PoseTrailTest, AnEarlierPoseReplacesLaterOnes) {
  PoseTrail trail;
  trail.add(pose_at(0, 0.0));
  trail.add(pose_at(10, 0.1));
  trail.add(pose_at(20, 0.2));
  trail.add(pose_at(10, 1.1));
  const auto pose = trail.at(Time(milliseconds(15)));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 1.15, 1e-9);
}

TEST(PoseTrailTest, MotionIsAnArcAndReversible) {
  PoseTrail trail;
  TrackedPose pose = pose_at(0, 5.0, radians(30.0));
  pose.yaw_rate_radps = 0.5;
  trail.add(pose);
  const auto there = trail.motion(Time(milliseconds(10)), Time(milliseconds(60)));
  ASSERT_TRUE(there);
  const Se2 arc{0.5 * std::cos(0.0125), 0.5 * std::sin(0.0125), 0.025};
  EXPECT_THAT(*there, test::PoseNear(arc, 1e-12, 1e-12)) << "in the vehicle frame, not in the map";
  const auto back = trail.motion(Time(milliseconds(60)), Time(milliseconds(10)));
  ASSERT_TRUE(back);
  const Se2 identity = *there * *back;
  EXPECT_THAT(identity, test::PoseNear({}, 1e-9, 1e-12));
}

TEST(PoseTrailTest, ACorrectionIsNoMotion) {
  PoseTrail trail;
  trail.add(pose_at(0, 0.0));
  trail.add(pose_at(50, 1.5));  // 0.5 m driven, 1 m corrected
  const auto motion = trail.motion(Time(milliseconds(0)), Time(milliseconds(50)));
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->x_m, 0.5, 1e-9);
}

TEST(PoseTrailTest, MotionUnderConstantBrakingUsesTheMeanSpeed) {
  PoseTrail trail;
  for (int i = 0; i <= 10; ++i) {
    TrackedPose pose = pose_at(10 * i, 0.0);
    pose.speed_mps = 10.0 - 0.05 * i;
    trail.add(pose);
  }
  const auto speed_mps = trail.speed_mps(Time(milliseconds(45)));
  ASSERT_TRUE(speed_mps);
  EXPECT_NEAR(*speed_mps, 9.775, 1e-9);
  const auto motion = trail.motion(Time(milliseconds(20)), Time(milliseconds(70)));
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->x_m, 0.05 * (10.0 - 0.05 * 4.5), 1e-9);
}

TEST(PoseTrailTest, ForgetsThePosesBeforeAGap) {
  PoseTrail trail;
  for (int ms = 0; ms <= 100; ms += 10) trail.add(pose_at(ms, 0.0));
  trail.add(pose_at(5000, 40.0));
  EXPECT_FALSE(trail.at(Time(milliseconds(100))));
  EXPECT_FALSE(trail.at(Time(milliseconds(3000)))) << "nothing is interpolated across the gap";
  EXPECT_TRUE(trail.at(Time(milliseconds(5000))));
}

TEST(PoseTrailTest, ReturnsNoMotionBeyondItsReach) {
  PoseTrail trail;
  EXPECT_FALSE(trail.motion(Time(milliseconds(0)), Time(milliseconds(0))));
  trail.add(pose_at(100, 0.0));
  EXPECT_FALSE(trail.motion(Time(milliseconds(0)), Time(milliseconds(50))));
  const Time late = Time(milliseconds(101)) + PoseTrail::kReach;
  EXPECT_FALSE(trail.motion(late, late));
}

}  // namespace
}  // namespace bevloc
