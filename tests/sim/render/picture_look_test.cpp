#include "sim/render/picture_look.h"

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

/// Columns of changing colour.
RgbImage stripes() {
  RgbImage image(32, 20);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      uint8_t* pixel = image.row(row) + 3 * column;
      pixel[0] = static_cast<uint8_t>(6 * column);
      pixel[1] = 100;
      pixel[2] = static_cast<uint8_t>(column % 2 == 0 ? 40 : 160);
    }
  }
  return image;
}

RgbImage with(const PictureLook& look) {
  RgbImage image = stripes();
  apply(look, image);
  return image;
}

TEST(PictureLook, ByDefaultNothingChanges) {
  EXPECT_EQ(with({}).pixels, stripes().pixels);
}

TEST(PictureLook, GainsChangeTheirOwnChannel) {
  const RgbImage bluer = with({.gain = {1.0F, 1.0F, 1.25F}});
  EXPECT_EQ(bluer.row(3)[3 * 7], stripes().row(3)[3 * 7]);
  EXPECT_EQ(bluer.row(3)[3 * 7 + 2], 200);
}

TEST(PictureLook, WithoutSaturationAllChannelsAreEqual) {
  const RgbImage grey = with({.saturation = 0.0F});
  for (size_t i = 0; i < grey.pixels.size(); i += 3) {
    EXPECT_EQ(grey.pixels[i], grey.pixels[i + 1]);
    EXPECT_EQ(grey.pixels[i], grey.pixels[i + 2]);
  }
}

TEST(PictureLook, ContrastAndSharpnessIncreaseDifferences) {
  const auto difference = [](const RgbImage& image) {
    return image.row(3)[3 * 7 + 2] - image.row(3)[3 * 8 + 2];
  };
  EXPECT_GT(difference(with({.contrast = 1.3F})), difference(stripes()));
  EXPECT_GT(difference(with({.sharpening = 0.5F})), difference(stripes()));
  EXPECT_LT(difference(with({.sharpening = -0.5F})), difference(stripes()));
  EXPECT_LT(difference(with({.smear_px = 1})), difference(stripes()));
}

TEST(PictureLook, TheVehicleHidesTheLowerEdge) {
  const RgbImage seen = with(
      {.bodywork = {.left = 0.5F, .middle = 0.1F, .right = 0.5F, .colour = {9, 9, 9}, .shine = 0}});
  EXPECT_EQ(seen.row(9)[1], 100);
  EXPECT_LE(seen.row(11)[1], 9) << "high at the left end";
  EXPECT_EQ(seen.row(11)[3 * 16 + 1], 100) << "low in the middle";
  EXPECT_LE(seen.row(19)[3 * 16 + 1], 9);
}

TEST(PictureLook, RowsAtTheLowerEdgeAreBlack) {
  const RgbImage seen = with({.contrast = 0.5F, .black_rows = 2});
  EXPECT_EQ(seen.row(18)[1], 0);
  EXPECT_EQ(seen.row(19)[3 * 31 + 2], 0);
  EXPECT_NE(seen.row(17)[1], 0);
}

}  // namespace
}  // namespace bevloc::sim
