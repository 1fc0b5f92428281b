// JPEG in memory, and the conversion of YUV images to RGB.
#include "common/jpeg.h"

#include <array>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

/// A smooth image: JPEG keeps it nearly unchanged.
RgbImage slope(int width, int height) {
  RgbImage image(width, height);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      uint8_t* pixel = image.row(row) + 3 * column;
      pixel[0] = static_cast<uint8_t>(4 * column);
      pixel[1] = static_cast<uint8_t>(4 * row);
      pixel[2] = 90;
    }
  }
  return image;
}

TEST(JpegTest, AnImageSurvives) {
  const RgbImage image = slope(48, 32);
  JpegEncoder encoder;
  const auto jpeg = encoder.encode(image.view(), 95);
  ASSERT_TRUE(jpeg) << jpeg.error().message;
  const auto decoded = decode_jpeg(*jpeg, "test");
  ASSERT_TRUE(decoded) << decoded.error().message;
  ASSERT_EQ(decoded->width, 48);
  ASSERT_EQ(decoded->height, 32);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    ASSERT_NEAR(image.pixels[i], decoded->pixels[i], 8) << "at " << i;
  }
}

TEST(JpegTest, DamagedAndCutFilesAreRefused) {
  JpegEncoder encoder;
  const RgbImage image = slope(48, 32);
  const std::string jpeg(encoder.encode(image.view(), 90).value());
  EXPECT_FALSE(decode_jpeg("", "test"));
  EXPECT_FALSE(decode_jpeg("no picture", "test"));
  const auto cut = decode_jpeg(std::string_view(jpeg).substr(0, jpeg.size() / 2), "camera front");
  ASSERT_FALSE(cut);
  EXPECT_TRUE(cut.error().message.starts_with("camera front: found a damaged JPEG"));
}

TEST(JpegTest, BayerIsRefused) {
  ImageView image;
  image.format = PixelFormat::kBayerRggb;
  JpegEncoder encoder;
  EXPECT_FALSE(can_encode_jpeg(image.format));
  EXPECT_FALSE(encoder.encode(image, 90));
}

/// The same red in each YUV format; BT.601 in limited range has it at (81, 90, 240).
TEST(JpegTest, EveryYuvFormatBecomesTheSameRgb) {
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

}  // namespace
}  // namespace bevloc
