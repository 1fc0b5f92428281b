#include "sim/vehicle/drive.h"

#include <gtest/gtest.h>

#include "sim/vehicle/route.h"
#include "sim/world/world_generator.h"
#include "tests/sim/geometry.h"

namespace bevloc::sim {
namespace {

void expect_poses_match_speed_and_yaw_rate(const Drive& drive) {
  constexpr double kStep_s = 0.02;
  for (double t = 0.0; t + kStep_s < drive.duration_s(); t += 0.11) {
    const Drive::State a = drive.at(t);
    const Drive::State b = drive.at(t + kStep_s);
    const Se2 motion = correction_between(a.map_from_vehicle, b.map_from_vehicle);
    const double mean_speed = 0.5 * (a.speed_mps + b.speed_mps);
    EXPECT_NEAR(motion.x_m, mean_speed * kStep_s, 0.02 * std::abs(mean_speed) * kStep_s + 0.002)
        << t;
    EXPECT_NEAR(motion.y_m, 0.0, 0.01 + 0.01 * std::abs(mean_speed) * kStep_s) << t;
    const double mean_rate = 0.5 * (a.yaw_rate_radps + b.yaw_rate_radps);
    EXPECT_NEAR(motion.yaw_rad, mean_rate * kStep_s, 0.002) << t;
  }
}

class DriveThroughTown : public testing::TestWithParam<uint64_t> {
 protected:
  static constexpr double kDuration_s = 120.0;
  const World world_ = generate_world(GetParam());
  const Drive drive_{world_, GetParam() + 1, kDuration_s};
};

INSTANTIATE_TEST_SUITE_P(Seeds, DriveThroughTown, testing::Range<uint64_t>(0, 30));

TEST_P(DriveThroughTown, KeepsItsLimits) {
  for (double t = 0.0; t < kDuration_s; t += 0.05) {
    const Drive::State state = drive_.at(t);
    EXPECT_LE(std::abs(state.speed_mps * state.yaw_rate_radps), 2.5) << t;
    EXPECT_LE(state.acceleration_mps2, 2.0) << t;
    EXPECT_GE(state.acceleration_mps2, -3.0) << t;
    EXPECT_GE(state.speed_mps, -1e-9) << t;
    EXPECT_LE(state.speed_mps, 25.0) << t;
  }
}

TEST_P(DriveThroughTown, StaysInItsLanes) {
  for (double t = 0.0; t < kDuration_s; t += 0.5) {
    const Eigen::Vector2d position = drive_.at(t).map_from_vehicle.translation();
    double nearest = 1e9;
    for (const Lane& lane : world_.map.lanes) {
      nearest = std::min(nearest, distance_to_line(position, lane.centerline));
    }
    EXPECT_LT(nearest, 0.8) << t;
  }
}

TEST_P(DriveThroughTown, PosesMatchSpeedAndYawRate) {
  expect_poses_match_speed_and_yaw_rate(drive_);
}

TEST_P(DriveThroughTown, PosesMatchSpeedAndYawRateWhereTheVehicleReverses) {
  const Pace pace({{30.0, 1.0}, {36.0, 0.0}, {38.0, -0.3}, {44.0, -0.3}, {46.0, 0.0}, {52.0, 1.0}});
  expect_poses_match_speed_and_yaw_rate({world_, GetParam() + 1, kDuration_s, {}, pace});
}

TEST_P(DriveThroughTown, DrivesAtLeast300Metres) {
  double driven_m = 0.0;
  for (double t = 0.0; t < kDuration_s; t += 0.1) driven_m += 0.1 * drive_.at(t).speed_mps;
  EXPECT_GT(driven_m, 300.0);
}

TEST_P(DriveThroughTown, BodyMotionIsThatOfACar) {
  double sum_squares = 0.0;
  int count = 0;
  for (double t = 0.0; t < kDuration_s; t += 0.1, ++count) {
    const BodyMotion body = drive_.body_at(t);
    sum_squares += body.pitch_rad * body.pitch_rad;
    EXPECT_LT(std::abs(body.pitch_rad), radians(2.5));
    EXPECT_LT(std::abs(body.roll_rad), radians(3.0));
    EXPECT_LT(std::abs(body.lift_m), 0.06);
  }
  EXPECT_GT(std::sqrt(sum_squares / count), radians(0.1));
  EXPECT_LT(std::sqrt(sum_squares / count), radians(0.8));
}

TEST(Drive, TheYawRateMatchesTheHeadingWhereAMapBendsSharplyAtTheEndsOfARoute) {
  constexpr double kDuration_s = 40.0;
  constexpr double kStep_s = 0.005;
  World world;
  world.map.lanes.resize(1);
  world.map.lanes[0].centerline = {{-2.0, 1.5}, {0.0, 0.0}, {80.0, 0.0}, {82.0, 1.5}};
  world.map.lanes[0].speed_limit_mps = 10.0;
  const Drive drive(world, 1, kDuration_s);
  Drive::State before = drive.at(0.0);
  double turned_rad = before.map_from_vehicle.yaw_rad;
  for (double t = kStep_s; t < kDuration_s; t += kStep_s) {
    const Drive::State now = drive.at(t);
    turned_rad += 0.5 * kStep_s * (before.yaw_rate_radps + now.yaw_rate_radps);
    ASSERT_NEAR(degrees(turned_rad), degrees(now.map_from_vehicle.yaw_rad), 0.05) << t;
    before = now;
  }
  EXPECT_EQ(before.speed_mps, 0.0) << "the route has ended";
}

TEST(Drive, ReversesAlongTheRouteBeforeItsPlannedStart) {
  constexpr double kDuration_s = 40.0;
  const World world = generate_world(4);
  const Drive planned(world, 9, kDuration_s);
  const Drive leaving(world, 9, kDuration_s, {},
                      Pace({{0.0, 0.0}, {2.0, 0.0}, {4.0, -0.5}, {10.0, -0.5}, {12.0, 0.0}}));
  EXPECT_EQ(leaving.at(1.0).speed_mps, 0.0);
  EXPECT_LT(leaving.at(7.0).speed_mps, -1.0);
  EXPECT_EQ(leaving.at(13.0).speed_mps, 0.0);
  const auto start = planned.at(0.0).map_from_vehicle;
  const auto farthest_back = leaving.at(13.0).map_from_vehicle;
  EXPECT_NEAR((start.translation() - farthest_back.translation()).norm(), 0.0, 1e-6);
  EXPECT_NEAR(farthest_back.yaw_rad, start.yaw_rad, 1e-9);
}

TEST(Drive, StandsUntilItsPaceLetsItGo) {
  const World world = generate_world(4);
  const Drive drive(world, 9, 40.0, {}, Pace({{10.0, 0.0}, {15.0, 1.0}}));
  const Se2 start = drive.at(0.0).map_from_vehicle;
  for (double t = 0.0; t <= 10.0; t += 0.5) {
    EXPECT_EQ(drive.at(t).map_from_vehicle.x_m, start.x_m) << t;
    EXPECT_EQ(drive.at(t).speed_mps, 0.0) << t;
  }
  EXPECT_GT(drive.at(14.0).speed_mps, 1.0);
}

TEST(Drive, IsDeterminedByItsSeed) {
  const World world = generate_world(4);
  const Drive a(world, 9, 30.0);
  const Drive b(world, 9, 30.0);
  const Drive other(world, 10, 30.0);
  const Se2 pose_a = a.at(17.3).map_from_vehicle;
  const Se2 pose_b = b.at(17.3).map_from_vehicle;
  EXPECT_EQ(pose_a.x_m, pose_b.x_m);
  EXPECT_EQ(pose_a.yaw_rad, pose_b.yaw_rad);
  EXPECT_NE(pose_a.x_m, other.at(17.3).map_from_vehicle.x_m);
}

TEST(Drive, NoseDipsWhenBraking) {
  const World world = generate_world(4);
  const Drive drive(world, 9, 300.0);
  double braking = 0.0;
  double speeding_up = 0.0;
  for (double t = 1.0; t < 299.0; t += 0.1) {
    const double acceleration = drive.at(t).acceleration_mps2;
    if (acceleration < -1.5) braking = std::max(braking, drive.body_at(t).pitch_rad);
    if (acceleration > 1.0) speeding_up = std::min(speeding_up, drive.body_at(t).pitch_rad);
  }
  EXPECT_GT(braking, radians(0.4));
  EXPECT_LT(speeding_up, radians(-0.2));
}

TEST(Drive, SometimesWaitsAtJunctions) {
  int waits = 0;
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const Drive drive(generate_world(seed), seed, 300.0);
    for (double t = 1.0; t < 299.0; t += 1.0) waits += drive.at(t).speed_mps == 0.0 ? 1 : 0;
  }
  EXPECT_GT(waits, 10);
}

/// One lane of 200 m without a successor.
World dead_end() {
  World world;
  Lane lane;
  lane.centerline = {{0.0, 0.0}, {200.0, 0.0}};
  lane.left = {{0.0, 1.5}, {200.0, 1.5}};
  lane.right = {{0.0, -1.5}, {200.0, -1.5}};
  world.map.lanes.push_back(lane);
  return world;
}

TEST(Drive, StopsWhereTheMapEnds) {
  const Drive drive(dead_end(), 1, 120.0);
  const Drive::State end = drive.at(120.0);
  EXPECT_EQ(end.speed_mps, 0.0);
  EXPECT_NEAR(end.map_from_vehicle.x_m, 200.0, 0.1);
  EXPECT_NEAR(drive.at(1e6).map_from_vehicle.x_m, end.map_from_vehicle.x_m, 1e-9);
  EXPECT_NEAR(drive.at(-5.0).map_from_vehicle.x_m, 0.0, 0.1);
}

TEST(Drive, TheRouteOfAFastRoadLastsForTheWholeDrive) {
  constexpr double kDuration_s = 600.0;
  constexpr double kLane_m = 100.0;
  World world;
  world.map.lanes.resize(200);
  for (uint32_t i = 0; i < world.map.lanes.size(); ++i) {
    Lane& lane = world.map.lanes[i];
    lane.centerline = {{kLane_m * i, 0.0}, {kLane_m * (i + 1), 0.0}};
    lane.speed_limit_mps = 36.0;
    if (i + 1 < world.map.lanes.size()) lane.successors = {i + 1};
  }
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    EXPECT_GT(Drive(world, seed, kDuration_s).at(kDuration_s - 1.0).speed_mps, 10.0) << seed;
  }
}

TEST(Route, AvoidsDeadEndsAndPrefersNewLanes) {
  // 0 -> {1, 2}, 1 -> 0; lane 2 is a dead end.
  HdMap map;
  for (int i = 0; i < 3; ++i) {
    Lane lane;
    lane.centerline = {{0.0, 10.0 * i}, {50.0, 10.0 * i}};
    map.lanes.push_back(lane);
  }
  map.lanes[0].successors = {1, 2};
  map.lanes[1].successors = {0};
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<uint32_t> route = random_lane_route(map, 1000.0, random);
    EXPECT_GE(route.size(), 20U);
    for (size_t i = 1; i < route.size(); ++i) {
      const auto& next = map.lanes[route[i - 1]].successors;
      EXPECT_NE(std::find(next.begin(), next.end(), route[i]), next.end());
    }
  }
}

TEST(Route, AlongLanesWithoutLengthEnds) {
  HdMap map;
  map.lanes.resize(1);
  map.lanes[0].centerline = {{5.0, 2.0}, {5.0, 2.0}};
  map.lanes[0].successors = {0};
  Random random(1);
  EXPECT_LE(random_lane_route(map, 100.0, random).size(), 10'001U);
}

TEST(Drive, WaitsAtStopsForTheGivenTime) {
  const World world = generate_world(7);
  int waits = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const Drive drive(world, seed, 200.0, {50.0, 60.0});
    double standing_s = 0.0;
    for (double time_s = 0.0; time_s < 200.0; time_s += 0.1) {
      if (drive.at(time_s).speed_mps > 0.0) {
        if (standing_s > 1.0) {
          EXPECT_GT(standing_s, 49.0) << seed;
          EXPECT_LT(standing_s, 62.0) << seed;
          ++waits;
        }
        standing_s = 0.0;
      } else {
        standing_s += 0.1;
      }
    }
  }
  EXPECT_GE(waits, 3);
}

}  // namespace
}  // namespace bevloc::sim
