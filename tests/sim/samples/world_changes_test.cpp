#include "sim/samples/world_changes.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {
namespace {

constexpr uint64_t kTownSeed = 17;

const World& town() {
  static const World world = generate_world(kTownSeed);
  return world;
}

TEST(WearPaint, MultipliesTheWearButLeavesSomePaint) {
  World world = town();
  wear_paint(2.0, world);
  ASSERT_FALSE(world.paint_lines.empty());
  for (size_t i = 0; i < world.paint_lines.size(); ++i) {
    EXPECT_FLOAT_EQ(world.paint_lines[i].wear, std::min(2.0F * town().paint_lines[i].wear, 0.95F));
  }
  ASSERT_FALSE(world.paint_areas.empty());
  for (size_t i = 0; i < world.paint_areas.size(); ++i) {
    EXPECT_FLOAT_EQ(world.paint_areas[i].wear, std::min(2.0F * town().paint_areas[i].wear, 0.95F));
  }
}

TEST(StandingVehicles, StandAroundThePoseButNotOnIt) {
  constexpr int kVehicles = 10;
  Random random(kTownSeed);
  const Se2 pose = random_pose_on_road(town(), random);
  World world = town();
  add_standing_vehicles({pose}, kVehicles, kTownSeed, world);
  const size_t before = town().parked.size();
  ASSERT_GT(world.parked.size(), before);
  EXPECT_LE(world.parked.size(), before + kVehicles);
  for (size_t i = before; i < world.parked.size(); ++i) {
    const Eigen::Vector2d place = pose.inverse() * world.parked[i].centre;
    EXPECT_LE(place.norm(), 25.0);
    const bool in_ego = place.x() > -0.9 && place.x() < 3.7 && std::abs(place.y()) < 0.9;
    EXPECT_FALSE(in_ego);
    for (size_t k = 0; k < i; ++k) {
      EXPECT_GT((world.parked[i].centre - world.parked[k].centre).norm(), 1.0);
    }
  }
}

TEST(StandingVehicles, NoneAreAddedForACountOfZero) {
  World world = town();
  add_standing_vehicles({Se2{}}, 0, kTownSeed, world);
  EXPECT_EQ(world.parked.size(), town().parked.size());
}

TEST(MapErrors, WithoutErrorsTheMapIsUnchanged) {
  const HdMap same = with_errors(town().map, {}, kTownSeed);
  ASSERT_EQ(same.elements.size(), town().map.elements.size());
  for (size_t i = 0; i < same.elements.size(); ++i) {
    EXPECT_EQ(same.elements[i].points, town().map.elements[i].points);
  }
}

TEST(MapErrors, OmitsAndDoublesAShareOfTheElements) {
  const size_t all = town().map.elements.size();
  ASSERT_GT(all, 100U);
  const size_t kept = with_errors(town().map, {.omission = 0.3}, kTownSeed).elements.size();
  EXPECT_LT(kept, all * 8 / 10);
  EXPECT_GT(kept, all * 6 / 10);
  const size_t doubled = with_errors(town().map, {.ghost = 0.3}, kTownSeed).elements.size();
  EXPECT_GT(doubled, all * 12 / 10);
  EXPECT_LT(doubled, all * 14 / 10);
}

TEST(MapErrors, ShiftsByDecimetresThatChangeFromPlaceToPlace) {
  constexpr double kSigma_m = 0.15;
  const HdMap shifted = with_errors(town().map, {.shift_sigma_m = kSigma_m}, kTownSeed);
  ASSERT_EQ(shifted.elements.size(), town().map.elements.size());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0.0;
  double largest = 0.0;
  for (size_t i = 0; i < shifted.elements.size(); ++i) {
    const Eigen::Vector2d shift =
        shifted.elements[i].points.front() - town().map.elements[i].points.front();
    sum += shift;
    squares += shift.squaredNorm();
    largest = std::max(largest, shift.norm());
  }
  const auto count = static_cast<double>(shifted.elements.size());
  EXPECT_NEAR(std::sqrt(0.5 * squares / count), kSigma_m, 0.5 * kSigma_m);
  EXPECT_LT(sum.norm() / count, kSigma_m);
  EXPECT_LT(largest, 1.0);
}

TEST(MapErrors, AreDeterminedByTheSeed) {
  const MapErrors errors{.omission = 0.1, .ghost = 0.1, .shift_sigma_m = 0.15};
  const auto first_point = [&errors](uint64_t seed) {
    return with_errors(town().map, errors, seed).elements.front().points.front();
  };
  EXPECT_EQ(first_point(1), first_point(1));
  EXPECT_NE(first_point(1), first_point(2));
}

}  // namespace
}  // namespace bevloc::sim
