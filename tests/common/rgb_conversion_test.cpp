// The colours of camera images in RGB.
#include "common/rgb_conversion.h"

#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

using testing::ElementsAre;

/// The same red in each YUV format; BT.601 in limited range has it at (81, 90, 240).
TEST(RgbConversion, EveryYuvFormatBecomesTheSameRgb) {
  const std::array<uint8_t, 8> yuyv{81, 90, 81, 240, 81, 90, 81, 240};
  const std::array<uint8_t, 8> uyvy{90, 81, 240, 81, 90, 81, 240, 81};
  const std::array<uint8_t, 4> luma{81, 81, 81, 81};
  const std::array<uint8_t, 2> chroma{90, 240};
  ImageView image;
  image.width = 2;
  image.height = 2;
  const auto expect_red = [&] {
    RgbImage rgb(2, 2);
    convert_to_rgb(image, rgb);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(rgb.pixels[3 * i], 254, 2);
      EXPECT_NEAR(rgb.pixels[3 * i + 1], 0, 2);
      EXPECT_NEAR(rgb.pixels[3 * i + 2], 0, 2);
    }
  };
  image.format = PixelFormat::kYuyv;
  image.planes[0] = {yuyv.data(), 4};
  expect_red();
  image.format = PixelFormat::kUyvy;
  image.planes[0] = {uyvy.data(), 4};
  expect_red();
  image.format = PixelFormat::kNv12;
  image.planes[0] = {luma.data(), 2};
  image.planes[1] = {chroma.data(), 2};
  expect_red();
}

/// BT.709 has another red than BT.601, and full range has black at 0.
TEST(RgbConversion, TheEncodingDecides) {
  const std::array<uint8_t, 4> yuyv{54, 99, 54, 255};  // red of BT.709 in full range
  ImageView image;
  image.format = PixelFormat::kYuyv;
  image.width = 2;
  image.height = 1;
  image.planes[0] = {yuyv.data(), 4};
  image.yuv = {YuvMatrix::kBt709, true};
  RgbImage rgb(2, 1);
  convert_to_rgb(image, rgb);
  EXPECT_NEAR(rgb.pixels[0], 255, 2);
  EXPECT_NEAR(rgb.pixels[1], 0, 2);
  EXPECT_NEAR(rgb.pixels[2], 0, 2);
  image.yuv = {YuvMatrix::kBt601, false};
  convert_to_rgb(image, rgb);
  EXPECT_NEAR(rgb.pixels[0], 247, 2);  // 255 / 219 * (54 - 16) + 1.596 * 127
}

TEST(RgbConversion, EveryStepthPixelIsTaken) {
  RgbImage image(7, 5);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<uint8_t>(i);
  RgbImage same(7, 5);
  convert_to_rgb(image.view(), same);
  EXPECT_EQ(same.pixels, image.pixels);
  RgbImage small(2, 1);
  convert_to_rgb(image.view(), small, 3);
  EXPECT_THAT(small.pixels, ElementsAre(0, 1, 2, 9, 10, 11));
}

/// Also at the odd right and lower edges.
TEST(RgbConversion, EachBayerOrderGivesTheColour) {
  constexpr uint8_t kRed = 180;
  constexpr uint8_t kGreen = 90;
  constexpr uint8_t kBlue = 30;
  const std::pair<PixelFormat, std::array<uint8_t, 4>> orders[] = {
      {PixelFormat::kBayerRggb, {kRed, kGreen, kGreen, kBlue}},
      {PixelFormat::kBayerGrbg, {kGreen, kRed, kBlue, kGreen}},
      {PixelFormat::kBayerGbrg, {kGreen, kBlue, kRed, kGreen}},
      {PixelFormat::kBayerBggr, {kBlue, kGreen, kGreen, kRed}}};
  constexpr int kWidth = 7;
  constexpr int kHeight = 5;
  for (const auto& [format, block] : orders) {
    std::vector<uint8_t> bytes;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      bytes.push_back(block[2 * (i / kWidth % 2) + i % kWidth % 2]);
    }
    ImageView image;
    image.format = format;
    image.width = kWidth;
    image.height = kHeight;
    image.planes[0] = {bytes.data(), kWidth};
    RgbImage rgb(kWidth, kHeight);
    convert_to_rgb(image, rgb);
    for (size_t i = 0; i < rgb.pixels.size(); i += 3) {
      EXPECT_THAT(std::vector(&rgb.pixels[i], &rgb.pixels[i] + 3), ElementsAre(kRed, kGreen, kBlue))
          << to_string(format) << ", pixel " << i / 3;
    }
  }
}

TEST(RgbConversion, ABayerImageOfOnePixelIsGrey) {
  const uint8_t pixel = 40;
  ImageView image;
  image.format = PixelFormat::kBayerBggr;
  image.width = 1;
  image.height = 1;
  image.planes[0] = {&pixel, 1};
  RgbImage rgb(1, 1);
  convert_to_rgb(image, rgb);
  EXPECT_THAT(rgb.pixels, ElementsAre(40, 40, 40));
}

}  // namespace
}  // namespace bevloc
