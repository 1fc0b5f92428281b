#include "sim/samples/training_nuisances.h"

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

constexpr int kDraws = 2000;

TEST(TrainingNuisances, AreDrawnInTheirSharesAndWithinTheirStrengths) {
  const TrainingNuisances strong = strong_nuisances();
  const Nuisances usual;
  int unsynchronised = 0;
  int worn = 0;
  int crowded = 0;
  int wrong_maps = 0;
  double most_calibration = 0.0;
  for (uint64_t seed = 0; seed < kDraws; ++seed) {
    const Nuisances of_world = drawn_for_world(usual, strong, seed);
    worn += of_world.paint_wear_factor != usual.paint_wear_factor ? 1 : 0;
    EXPECT_GE(of_world.paint_wear_factor, 1.0);
    EXPECT_LE(of_world.paint_wear_factor, 2.0);
    crowded += of_world.extra_vehicles > 0 ? 1 : 0;
    EXPECT_LE(of_world.extra_vehicles, 8);
    wrong_maps += of_world.map_errors == nuisances_of(NuisanceSet::kMapErrors).map_errors ? 1 : 0;

    const Nuisances drawn = drawn_for_sample(of_world, strong, seed);
    unsynchronised += drawn.desynchronisation.spread_s > 0.0 ? 1 : 0;
    EXPECT_TRUE(drawn.desynchronisation.compensated);
    EXPECT_GE(drawn.body.tilt_rad, radians(0.2));
    EXPECT_LE(drawn.body.tilt_rad, radians(1.0));
    const double factor = drawn.calibration.rotation_rad / usual.calibration.rotation_rad;
    EXPECT_NEAR(drawn.calibration.position_m, factor * usual.calibration.position_m, 1e-12);
    EXPECT_NEAR(drawn.calibration.relative_focal, factor * usual.calibration.relative_focal, 1e-12);
    most_calibration = std::max(most_calibration, factor);
    EXPECT_GE(factor, 1.0 - 1e-9);
    EXPECT_EQ(drawn.extra_vehicles, of_world.extra_vehicles);
  }
  EXPECT_NEAR(unsynchronised, 0.25 * kDraws, 0.03 * kDraws);
  EXPECT_NEAR(worn, 0.2 * kDraws, 0.03 * kDraws);
  EXPECT_NEAR(crowded, 0.2 * kDraws, 0.03 * kDraws);
  EXPECT_NEAR(wrong_maps, 0.15 * kDraws, 0.03 * kDraws);
  EXPECT_GT(most_calibration, 1.65);
  EXPECT_LE(most_calibration, 1.7 + 1e-9);
}

TEST(TrainingNuisances, OfTheStreetAddLooksHabitsAndVerges) {
  const TrainingNuisances street = street_nuisances();
  int looks = 0;
  int habits = 0;
  int verges = 0;
  int clear = 0;
  for (uint64_t seed = 0; seed < kDraws; ++seed) {
    const Nuisances of_world = drawn_for_world({}, street, seed);
    habits += of_world.map_habits != MapHabits{} ? 1 : 0;
    verges += of_world.verge_share > 0.0 ? 1 : 0;
    const Nuisances drawn = drawn_for_sample(of_world, street, seed);
    looks += drawn.looks != CameraLooks{} ? 1 : 0;
    clear += drawn.noise_factor < 1.0 ? 1 : 0;
    EXPECT_EQ(drawn.map_habits, of_world.map_habits);
    EXPECT_EQ(drawn.body.tilt_rad, drawn_for_sample({}, strong_nuisances(), seed).body.tilt_rad);
  }
  EXPECT_NEAR(looks, 0.8 * kDraws, 0.03 * kDraws);
  EXPECT_NEAR(habits, 0.5 * kDraws, 0.03 * kDraws);
  EXPECT_NEAR(verges, 0.3 * kDraws, 0.03 * kDraws);
  EXPECT_NEAR(clear, 0.7 * kDraws, 0.03 * kDraws);
}

TEST(TrainingNuisances, EachCanBeEnabledOnItsOwn) {
  TrainingNuisances one;
  one.extra_vehicles = strong_nuisances().extra_vehicles;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const Nuisances drawn = drawn_for_sample(drawn_for_world({}, one, seed), one, seed);
    EXPECT_EQ(drawn.extra_vehicles, drawn_for_world({}, strong_nuisances(), seed).extra_vehicles);
    EXPECT_EQ(drawn.body.tilt_rad, Nuisances{}.body.tilt_rad);
    EXPECT_EQ(drawn.calibration.rotation_rad, Nuisances{}.calibration.rotation_rad);
    EXPECT_EQ(drawn.paint_wear_factor, 1.0);
    EXPECT_EQ(drawn.desynchronisation.spread_s, 0.0);
    EXPECT_TRUE(drawn.map_errors == MapErrors{});
  }
}

}  // namespace
}  // namespace bevloc::sim
