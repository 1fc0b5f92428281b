#include "common/image_file.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "common/files.h"
#include "common/jpeg.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

class ImageFile : public testing::Test {
 protected:
  std::string path(const char* name) const { return (folder_ / name).string(); }

  /// A smooth image, in which each pixel has another value. `png_format`: one of libpng's.
  static std::vector<uint8_t> smooth_pixels(png_uint_32 png_format) {
    const size_t channels = PNG_IMAGE_SAMPLE_CHANNELS(png_format);
    std::vector<uint8_t> pixels;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const auto blue = static_cast<uint8_t>(40 + 3 * u);
        const uint8_t rgba[] = {static_cast<uint8_t>(200 - 2 * u - v),
                                static_cast<uint8_t>(90 + 5 * v), blue, 255};
        if (channels == 1) {
          pixels.push_back(blue);
        } else {
          pixels.insert(pixels.end(), rgba, rgba + channels);
        }
      }
    }
    return pixels;
  }

  std::string smooth_png(const char* name, png_uint_32 format = PNG_FORMAT_RGB) const {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = kWidth;
    image.height = kHeight;
    image.format = format;
    const std::vector<uint8_t> pixels = smooth_pixels(format);
    EXPECT_NE(png_image_write_to_file(&image, path(name).c_str(), 0, pixels.data(), 0, nullptr), 0);
    return path(name);
  }

  std::string smooth_jpeg(const char* name) const {
    const std::vector<uint8_t> pixels = smooth_pixels(PNG_FORMAT_RGB);
    JpegEncoder encoder;
    const auto jpeg = encoder.encode(RgbView{pixels.data(), kWidth, kHeight, 3 * kWidth}, 95);
    EXPECT_TRUE(jpeg && write_file(path(name), *jpeg));
    return path(name);
  }

  static void expect_smooth_image(const RgbImage& image, int tolerance) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const uint8_t* const rgb = image.row(v) + 3 * u;
        EXPECT_NEAR(rgb[0], 200 - 2 * u - v, tolerance) << u << ", " << v;
        EXPECT_NEAR(rgb[1], 90 + 5 * v, tolerance) << u << ", " << v;
        EXPECT_NEAR(rgb[2], 40 + 3 * u, tolerance) << u << ", " << v;
      }
    }
  }

  static constexpr int kWidth = 24;
  static constexpr int kHeight = 16;
  const test::TemporaryFolder folder_;
};

TEST_F(ImageFile, ReadsPngWithAndWithoutAlpha) {
  for (const png_uint_32 format : {PNG_FORMAT_RGB, PNG_FORMAT_RGBA}) {
    RgbImage image(kWidth, kHeight);
    const Status read = read_image(smooth_png("a.png", format), image);
    ASSERT_TRUE(read) << read.error().message;
    expect_smooth_image(image, 0);
  }
}

TEST_F(ImageFile, ReadsGreyPngAsRgb) {
  RgbImage image(kWidth, kHeight);
  ASSERT_TRUE(read_image(smooth_png("grey.png", PNG_FORMAT_GRAY), image));
  for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(image.row(3)[3 * 5 + channel], 40 + 15);
}

TEST_F(ImageFile, ReadsJpeg) {
  RgbImage image(kWidth, kHeight);
  const Status read = read_image(smooth_jpeg("a.jpg"), image);
  ASSERT_TRUE(read) << read.error().message;
  expect_smooth_image(image, 8);
}

TEST_F(ImageFile, WritesWhatItReads) {
  RgbImage image(kWidth, kHeight);
  ASSERT_TRUE(read_image(smooth_png("a.png"), image));
  ASSERT_TRUE(write_png(image.view(), path("b.png")));
  RgbImage again(kWidth, kHeight);
  ASSERT_TRUE(read_image(path("b.png"), again));
  EXPECT_EQ(again.pixels, image.pixels);
}

TEST_F(ImageFile, SaysWhatIsWrong) {
  RgbImage image(kWidth, kHeight);
  const auto error_of = [&](const std::string& name) {
    const Status read = read_image(path(name.c_str()), image);
    return read ? "no error" : read.error().message;
  };
  EXPECT_THAT(error_of("gone.png"), HasSubstr("gone.png: found no readable file"));

  ASSERT_TRUE(write_file(path("text.png"), "not an image"));
  EXPECT_THAT(error_of("text.png"),
              EndsWith("text.png: found a file that is neither PNG nor JPEG, wanted an image"));

  RgbImage wide(kWidth + 1, kHeight);
  ASSERT_TRUE(write_png(wide.view(), path("wide.png")));
  EXPECT_THAT(error_of("wide.png"),
              EndsWith("wide.png: found an image of 25x16 pixels, wanted 24x16"));

  for (const std::string& file : {smooth_png("cut.png"), smooth_jpeg("cut.jpg")}) {
    const std::string whole = read_file(file).value();
    ASSERT_TRUE(write_file(file, whole.substr(0, whole.size() * 3 / 4)));
    const std::string name = std::filesystem::path(file).filename();
    EXPECT_THAT(error_of(name), AllOf(HasSubstr(name), HasSubstr("found a damaged"))) << name;
  }
  EXPECT_FALSE(write_png(image.view(), path("no/such/folder.png")));
}

TEST_F(ImageFile, ThePictureOfACameraIsNotTurned) {
  // A segment with a TIFF file of one entry, whose last number but two is the orientation.
  const auto turned = [&](char orientation) {
    std::string jpeg = read_file(smooth_jpeg("turned.jpg")).value();
    std::string exif(
        "\xFF\xE1\0\x22"
        "Exif\0\0"
        "MM\0*\0\0\0\x08"
        "\0\1"
        "\x01\x12\0\3\0\0\0\1\0?\0\0"
        "\0\0\0\0",
        36);
    exif[exif.find('?')] = orientation;
    EXPECT_TRUE(write_file(path("turned.jpg"), jpeg.insert(2, exif)));
    return path("turned.jpg");
  };
  RgbImage image(kWidth, kHeight);
  EXPECT_THAT(read_camera_picture(turned(3), image).error().message,
              EndsWith("turned.jpg: found EXIF orientation 3, wanted 1: store the picture turned, "
                       "or remove the tag if the calibration is of the stored pixels"));
  EXPECT_TRUE(read_image(turned(3), image)) << "only cameras have a calibration";
  for (const std::string& file : {turned(1), smooth_jpeg("plain.jpg"), smooth_png("plain.png")}) {
    const Status read = read_camera_picture(file, image);
    ASSERT_TRUE(read) << read.error().message;
    expect_smooth_image(image, 8);
  }
  RgbImage wide(kWidth + 1, kHeight);
  EXPECT_THAT(read_camera_picture(path("plain.png"), wide).error().message,
              EndsWith("found an image of 24x16 pixels, wanted 25x16 as image_size_px in the rig; "
                       "pictures of another size need another calibration"));
}

/// Writes 16-bit samples as they are. libpng's simplified writer would convert them.
void write_png_with_16_bits(const std::string& path, const std::vector<uint8_t>& rgb, int width,
                            int height) {
  FILE* const file = fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 16,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  std::vector<uint8_t> row(static_cast<size_t>(6 * width));
  for (int v = 0; v < height; ++v) {
    for (size_t i = 0; i < row.size(); ++i) {
      row[i] = rgb[static_cast<size_t>(3 * width * v) + i / 2];
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  fclose(file);
}

TEST_F(ImageFile, SixteenBitsGiveThePictureOfEight) {
  const std::vector<uint8_t> pixels = smooth_pixels(PNG_FORMAT_RGB);
  write_png_with_16_bits(path("deep.png"), pixels, kWidth, kHeight);
  RgbImage image(kWidth, kHeight);
  const Status read = read_image(path("deep.png"), image);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(std::ranges::equal(image.pixels, pixels));
}

}  // namespace
}  // namespace bevloc
