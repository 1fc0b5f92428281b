#include "sim/samples/camera_looks.h"

#include <cmath>

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

constexpr uint64_t kLookSeeds = 300;
constexpr CameraLooks kColourful{
    .cast = 0.25, .least_saturation = 0.0, .most_saturation = 1.5, .grey_share = 0.25};

TEST(CameraLooks, WithoutRangesPicturesDoNotChange) {
  for (const PictureLook& look : random_looks({}, 3)) {
    EXPECT_EQ(look.gain, (std::array<float, 3>{1.0F, 1.0F, 1.0F}));
    EXPECT_EQ(look.saturation, 1.0F);
    EXPECT_EQ(look.contrast, 1.0F);
    EXPECT_EQ(look.gamma, 1.0F);
    EXPECT_EQ(look.smear_px, 0);
    EXPECT_EQ(look.black_rows, 0);
    EXPECT_FALSE(look.bodywork.is_visible());
  }
}

TEST(CameraLooks, StayInTheirRanges) {
  int grey = 0;
  for (uint64_t seed = 0; seed < kLookSeeds; ++seed) {
    const auto looks = random_looks(kColourful, seed);
    for (const PictureLook& look : looks) {
      for (const float gain : look.gain) {
        EXPECT_LE(std::abs(std::log(gain)), 1.17 * std::log(1.25));
      }
      EXPECT_GE(look.saturation, 0.0F);
      EXPECT_LE(look.saturation, 1.5F);
    }
    grey += looks[0].saturation == 0.0F ? 1 : 0;
  }
  EXPECT_GT(grey, 0.15 * kLookSeeds);
  EXPECT_LT(grey, 0.35 * kLookSeeds);
}

TEST(CameraLooks, CamerasOfAVehicleDifferLittle) {
  for (uint64_t seed = 0; seed < kLookSeeds; ++seed) {
    const auto looks = random_looks(kColourful, seed);
    for (const PictureLook& look : looks) {
      EXPECT_EQ(look.saturation, looks[0].saturation);
      EXPECT_NEAR(look.gain[0] / looks[0].gain[0], 1.0, 0.09);
    }
  }
}

TEST(CameraLooks, SomeVehiclesShowThemselves) {
  int showing = 0;
  for (uint64_t seed = 0; seed < kLookSeeds; ++seed) {
    const auto looks = random_looks({.body_share = 0.5}, seed);
    int cameras = 0;
    for (const PictureLook& look : looks) cameras += look.bodywork.is_visible() ? 1 : 0;
    showing += cameras > 0 ? 1 : 0;
  }
  EXPECT_GT(showing, 0.35 * kLookSeeds);
  EXPECT_LT(showing, 0.65 * kLookSeeds);
}

TEST(CameraLooks, AFactorWidensTheRanges) {
  const CameraLooks wide = scaled(kColourful, 1.2);
  EXPECT_DOUBLE_EQ(wide.cast, 0.3);
  EXPECT_DOUBLE_EQ(wide.most_saturation, 1.6);
  EXPECT_DOUBLE_EQ(wide.least_saturation, 0.0);
  EXPECT_EQ(scaled(kColourful, 0.0), CameraLooks());
}

}  // namespace
}  // namespace bevloc::sim
