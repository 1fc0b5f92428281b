#include "sim/vehicle/placement.h"

#include <gtest/gtest.h>

#include "sim/world/world_generator.h"
#include "tests/sim/geometry.h"

namespace bevloc::sim {
namespace {

TEST(RandomPoseOnRoad, LiesOnLanesWithSomeSpread) {
  double sum_squares = 0.0;
  int count = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const World world = generate_world(seed);
    Random random(seed);
    for (int i = 0; i < 40; ++i, ++count) {
      const Se2 pose = random_pose_on_road(world, random);
      double nearest = 1e9;
      for (const Lane& lane : world.map.lanes) {
        nearest = std::min(nearest, distance_to_line(pose.translation(), lane.centerline));
      }
      EXPECT_LT(nearest, 2.3);
      sum_squares += nearest * nearest;
    }
  }
  EXPECT_GT(std::sqrt(sum_squares / count), 0.15);
}

TEST(RandomPoseOnRoad, HasMapElementsNearby) {
  const World world = generate_world(3);
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    const Se2 pose = random_pose_on_road(world, random);
    const auto near = [&](const MapElement& element) {
      return distance_to_line(pose.translation(), element.points) < 30.0;
    };
    EXPECT_GE(std::count_if(world.map.elements.begin(), world.map.elements.end(), near), 2);
  }
}

TEST(RandomPoseOnRoad, ReturnsAPoseEvenWithoutMapElements) {
  World world;
  Lane lane;
  lane.centerline = {{0.0, 0.0}, {100.0, 0.0}};
  lane.left = {{0.0, 1.5}, {100.0, 1.5}};
  lane.right = {{0.0, -1.5}, {100.0, -1.5}};
  world.map.lanes.push_back(lane);
  Random random(1);
  EXPECT_TRUE(random_pose_on_road(world, random).is_finite());
}

}  // namespace
}  // namespace bevloc::sim
