// Tests the pictures of the live page.
#include "firmware/live/picture.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/jpeg.h"

namespace bevloc::firmware {
namespace {

/// Checks that the picture of `image` has this colour in its middle.
void expect_colour(const ImageView& image, int red, int green, int blue) {
  PictureMaker pictures;
  const auto jpeg = pictures.jpeg_of(image);
  ASSERT_TRUE(jpeg) << jpeg.error().message;
  const RgbImage picture = decode_jpeg(*jpeg, "picture").value();
  const uint8_t* const middle = picture.row(picture.height / 2) + 3 * (picture.width / 2);
  EXPECT_NEAR(middle[0], red, 6);
  EXPECT_NEAR(middle[1], green, 6);
  EXPECT_NEAR(middle[2], blue, 6);
}

ImageView view_of(PixelFormat format, int width, int height, const std::vector<uint8_t>& bytes,
                  int stride_bytes) {
  ImageView view;
  view.format = format;
  view.width = width;
  view.height = height;
  view.planes[0] = {bytes.data(), stride_bytes};
  return view;
}

TEST(PictureMaker, MakesLargeImagesSmaller) {
  const RgbImage image(1920, 1080);
  PictureMaker pictures;
  const auto jpeg = pictures.jpeg_of(image.view());
  ASSERT_TRUE(jpeg) << jpeg.error().message;
  const RgbImage picture = decode_jpeg(*jpeg, "picture").value();
  EXPECT_EQ(picture.width, 640);
  EXPECT_EQ(picture.height, 360);
}

TEST(PictureMaker, KeepsColoursOfRgb) {
  RgbImage image(64, 32);
  for (size_t i = 0; i < image.pixels.size(); i += 3) image.pixels[i] = 200;
  expect_colour(image.view(), 200, 0, 0);
}

/// tests/common/rgb_conversion_test.cpp tests the other formats.
TEST(PictureMaker, ConvertsYuv) {
  // Full range BT.601: (120, 90, 160) is R 164.9, G 110.2, B 52.7.
  std::vector<uint8_t> yuyv;
  for (int i = 0; i < 32 * 32; ++i) yuyv.insert(yuyv.end(), {120, 90, 120, 160});
  ImageView view = view_of(PixelFormat::kYuyv, 64, 32, yuyv, 128);
  view.yuv.full_range = true;
  expect_colour(view, 165, 110, 53);
}

TEST(PictureMaker, ReadsJpegAndRefusesADamagedOne) {
  RgbImage image(1280, 720);
  for (size_t i = 1; i < image.pixels.size(); i += 3) image.pixels[i] = 150;
  PictureMaker pictures;
  const auto first = pictures.jpeg_of(image.view());
  ASSERT_TRUE(first);
  const std::vector<uint8_t> file(first->begin(), first->end());
  ImageView view = view_of(PixelFormat::kMjpeg, 640, 360, file, 0);
  view.bytes_used = file.size();
  expect_colour(view, 0, 150, 0);
  view.bytes_used = 20;
  EXPECT_FALSE(pictures.jpeg_of(view));
  view.bytes_used = file.size();
  view.width = 320;
  EXPECT_FALSE(pictures.jpeg_of(view)) << "another size than the camera's";
  EXPECT_FALSE(pictures.jpeg_of(ImageView()));
}

}  // namespace
}  // namespace bevloc::firmware
