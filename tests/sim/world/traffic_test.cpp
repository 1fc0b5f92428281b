#include "sim/world/traffic.h"

#include <gtest/gtest.h>

#include "sim/world/world_generator.h"
#include "tests/sim/geometry.h"

namespace bevloc::sim {
namespace {

TEST(Traffic, MovesAtItsSpeedInItsHeading) {
  TrafficVehicle vehicle;
  vehicle.path = {{0.0, 0.0}, {0.0, 200.0}};
  vehicle.start_m = 10.0;
  vehicle.speed_mps = 8.0;
  const VehicleBody now = traffic_at({vehicle}, 0.0).front();
  const VehicleBody later = traffic_at({vehicle}, 2.5).front();
  EXPECT_NEAR(later.centre.y() - now.centre.y(), 20.0, 1e-9);
  EXPECT_NEAR(later.centre.x(), 0.0, 1e-9);
  EXPECT_NEAR(later.yaw_rad, std::numbers::pi / 2.0, 1e-9);
}

TEST(Traffic, RestartsAtTheEndOfItsPath) {
  TrafficVehicle vehicle;
  vehicle.path = {{0.0, 0.0}, {50.0, 0.0}};
  vehicle.speed_mps = 10.0;
  for (double t = 0.0; t < 60.0; t += 0.7) {
    const VehicleBody body = traffic_at({vehicle}, t).front();
    EXPECT_GE(body.centre.x(), 0.0);
    EXPECT_LE(body.centre.x(), 50.0);
  }
}

TEST(Traffic, AlongLanesWithoutLengthEnds) {
  HdMap map;
  map.lanes.resize(2);
  map.lanes[0].centerline = {{0.0, 0.0}, {100.0, 0.0}};
  map.lanes[0].successors = {1};
  map.lanes[1].centerline = {{100.0, 0.0}, {100.0, 0.0}};
  map.lanes[1].successors = {1};
  Random random(1);
  EXPECT_FALSE(random_traffic(map, 10.0, random).empty());
}

TEST(Traffic, FollowsLanes) {
  const World world = generate_world(5);
  ASSERT_FALSE(world.traffic.empty());
  for (const VehicleBody& body : traffic_at(world.traffic, 12.3)) {
    double nearest = 1e9;
    for (const Lane& lane : world.map.lanes) {
      nearest = std::min(nearest, distance_to_line(body.centre, lane.centerline));
    }
    EXPECT_LT(nearest, 0.5);
  }
}

}  // namespace
}  // namespace bevloc::sim
