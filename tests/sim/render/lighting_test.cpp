#include "sim/render/lighting.h"

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

TEST(RandomConditions, AreMostlyDayWithSomeDuskNightAndRain) {
  constexpr int kDraws = 4000;
  int night = 0;
  int dusk = 0;
  int rain = 0;
  for (uint64_t seed = 0; seed < kDraws; ++seed) {
    const Conditions conditions = random_conditions(seed);
    night += conditions.sun_elevation_rad < -0.15 ? 1 : 0;
    dusk += conditions.sun_elevation_rad >= -0.15 && conditions.sun_elevation_rad < 0.17 ? 1 : 0;
    rain += conditions.rain > 0.0 ? 1 : 0;
    EXPECT_GT(conditions.exposure, 0.3);
    EXPECT_GE(conditions.overcast, 0.0);
    EXPECT_LE(conditions.overcast, 1.0);
    EXPECT_LE(conditions.rain, 1.0);
  }
  EXPECT_NEAR(night, 0.10 * kDraws, 0.02 * kDraws);
  EXPECT_NEAR(dusk, 0.12 * kDraws, 0.02 * kDraws);
  EXPECT_NEAR(rain, 0.15 * kDraws, 0.02 * kDraws);
}

TEST(RandomConditions, RepeatWithTheSeed) {
  EXPECT_EQ(random_conditions(5).sun_azimuth_rad, random_conditions(5).sun_azimuth_rad);
  EXPECT_NE(random_conditions(5).sun_azimuth_rad, random_conditions(6).sun_azimuth_rad);
}

TEST(Lighting, LampsAreOnOnlyAtNight) {
  Conditions conditions;
  EXPECT_EQ(lighting_of(conditions).headlights, 0.0F);
  EXPECT_TRUE(lighting_of(conditions).casts_shadows());
  conditions.sun_elevation_rad = -0.5;
  EXPECT_GT(lighting_of(conditions).headlights, 0.0F);
  EXPECT_GT(lighting_of(conditions).lamps, 0.0F);
  EXPECT_FALSE(lighting_of(conditions).casts_shadows());
}

TEST(Lighting, CloudsBlockTheSun) {
  Conditions clear;
  clear.overcast = 0.0;
  Conditions grey;
  grey.overcast = 1.0;
  EXPECT_GT(lighting_of(clear).sun.g, lighting_of(clear).ambient.g);
  EXPECT_LT(lighting_of(grey).sun.g, 0.01F);
}

}  // namespace
}  // namespace bevloc::sim
