// JPEG in memory.
#include "common/jpeg.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/jpeg_markers.h"

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

/// An image with four rows of blocks. USB cameras put such bytes before a marker.
std::string with_extra_bytes_before(uint8_t marker) {
  const test::RestartMarkers markers;
  JpegEncoder encoder;
  std::string jpeg(encoder.encode(slope(48, 64).view(), 95).value());
  for (const int number : {0, 1, 2}) {
    EXPECT_LT(test::place_of(test::restart_marker(number), jpeg), jpeg.size());
  }
  return jpeg.insert(test::place_of(marker, jpeg), 64, '\0');
}

TEST(JpegTest, ExtraBytesBeforeAMarkerAreNoDamage) {
  const RgbImage image = slope(48, 64);
  JpegEncoder encoder;
  const RgbImage wanted = decode_jpeg(encoder.encode(image.view(), 95).value(), "plain").value();
  for (const uint8_t marker :
       {test::restart_marker(0), test::restart_marker(2), test::kEndMarker}) {
    const auto decoded = decode_jpeg(with_extra_bytes_before(marker), "padded");
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(decoded->pixels, wanted.pixels);
  }
}

/// libjpeg tells its first warning only, which is the one about the extra bytes.
TEST(JpegTest, DamageAfterExtraBytesIsFound) {
  const std::string jpeg = with_extra_bytes_before(test::restart_marker(0));
  const auto place = [&jpeg](uint8_t marker) { return test::place_of(marker, jpeg); };
  const size_t second = place(test::restart_marker(1));
  const size_t third = place(test::restart_marker(2));
  const size_t end = place(test::kEndMarker);
  std::string without_third_row = jpeg;
  without_third_row.erase(second, third - second);
  std::string without_last_row = jpeg;
  without_last_row.erase(third, end - third);
  EXPECT_TRUE(decode_jpeg(jpeg, "whole"));
  EXPECT_FALSE(decode_jpeg(jpeg.substr(0, third), "cut off"));
  EXPECT_FALSE(decode_jpeg(jpeg.substr(0, end), "without its end marker"));
  EXPECT_FALSE(decode_jpeg(without_third_row, "with a gap"));
  EXPECT_FALSE(decode_jpeg(without_last_row, "too short"));
}

TEST(JpegTest, BayerIsRefused) {
  ImageView image;
  image.format = PixelFormat::kBayerRggb;
  JpegEncoder encoder;
  EXPECT_FALSE(can_encode_jpeg(image.format));
  EXPECT_FALSE(encoder.encode(image, 90));
}

TEST(JpegTest, ADecoderReadsOneFileAfterTheOtherAndReduces) {
  JpegEncoder encoder;
  const std::string large(encoder.encode(slope(48, 31).view(), 95).value());
  const std::string flat(encoder.encode(RgbImage(16, 8).view(), 95).value());
  JpegDecoder decoder;
  ASSERT_TRUE(decoder.open(large, "large"));
  EXPECT_EQ(decoder.width_px(), 48);
  EXPECT_EQ(decoder.height_px(), 31);
  RgbImage half(24, 16);
  ASSERT_TRUE(decoder.decode(half));
  const uint8_t* const pixel = half.row(5) + 3 * 10;
  EXPECT_NEAR(pixel[0], 4 * 20.5, 8);
  EXPECT_NEAR(pixel[1], 4 * 10.5, 8);
  EXPECT_NEAR(pixel[2], 90, 8);
  ASSERT_TRUE(decoder.open(flat, "flat"));
  EXPECT_EQ(decoder.width_px(), 16);
  RgbImage whole(16, 8);
  std::ranges::fill(whole.pixels, uint8_t{77});
  ASSERT_TRUE(decoder.decode(whole));
  EXPECT_NEAR(whole.row(7)[3 * 15], 0, 2);
}

}  // namespace
}  // namespace bevloc
