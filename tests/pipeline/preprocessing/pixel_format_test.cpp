// The same image in each camera format gives the same network input.
#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "pipeline/preprocessing/image_remap.h"
#include "tests/pipeline/preprocessing/camera_images.h"
#include "tests/pipeline/preprocessing/surround_rig.h"
#include "tests/support/jpeg_markers.h"

namespace bevloc {
namespace {

using Planes = std::vector<int8_t>;

constexpr YuvEncoding k601Limited{YuvMatrix::kBt601, false};
constexpr YuvEncoding k601Full{YuvMatrix::kBt601, true};
constexpr YuvEncoding k709Limited{YuvMatrix::kBt709, false};

CameraModel camera_of_size(int width_px, int height_px) {
  CameraModel camera = test::camera_at(1.5, 0.0, 1.5, 0.0, radians(65.0), 0.02);
  Intrinsics& intrinsics = camera.intrinsics;
  const double scale = width_px / static_cast<double>(intrinsics.width_px);
  intrinsics.width_px = width_px;
  intrinsics.height_px = height_px;
  intrinsics.fx_px *= scale;
  intrinsics.fy_px *= scale;
  intrinsics.cx_px *= scale;
  intrinsics.cy_px *= scale;
  return camera;
}

/// Colour waves of ten network pixels, without saturation.
RgbImage colourful(int width_px, int height_px) {
  RgbImage image(width_px, height_px);
  const double wave = 2.0 * M_PI / (10.0 * width_px / kNetworkWidthPx);
  std::vector<double> sines;  // because most of the time would go into sin() for each pixel
  for (int i = 0; i < width_px + height_px; ++i) sines.push_back(std::sin(wave * i));
  for (int v = 0; v < height_px; ++v) {
    const uint8_t green = test::to_byte(120.0 + 60.0 * std::cos(wave * v));
    for (int u = 0; u < width_px; ++u) {
      uint8_t* pixel = image.row(v) + 3 * u;
      pixel[0] = test::to_byte(128.0 + 60.0 * sines[u]);
      pixel[1] = green;
      pixel[2] = test::to_byte(110.0 + 60.0 * sines[u + v]);
    }
  }
  return image;
}

struct FormatCase {
  std::string name;
  std::function<test::CameraImage(const RgbImage&)> convert;
  int worst;    ///< largest allowed difference of a value
  double mean;  ///< largest allowed mean difference
};

class EachFormat : public testing::TestWithParam<std::tuple<FormatCase, std::pair<int, int>>> {};

TEST_P(EachFormat, GivesTheInputOfTheRgbImage) {
  const auto& [format, size] = GetParam();
  const RgbImage image = colourful(size.first, size.second);
  const test::CameraImage converted = format.convert(image);
  ImagePreprocessor preprocessor(camera_of_size(size.first, size.second));
  Planes wanted(kNetworkImageSize);
  Planes planes(kNetworkImageSize);
  ASSERT_TRUE(preprocessor.run(image.view(), wanted));
  const Status status = preprocessor.run(converted.view, planes);
  ASSERT_TRUE(status) << status.error().message;
  int worst = 0;
  double sum = 0.0;
  for (size_t i = 0; i < planes.size(); ++i) {
    const int difference = std::abs(planes[i] - wanted[i]);
    worst = std::max(worst, difference);
    sum += difference;
  }
  EXPECT_LE(worst, format.worst);
  EXPECT_LE(sum / static_cast<double>(planes.size()), format.mean);
}

FormatCase packed(const std::string& name, PixelFormat format, YuvEncoding encoding) {
  return {name, [=](const RgbImage& image) { return test::packed_image(image, format, encoding); },
          8, 1.2};
}

FormatCase nv12(const std::string& name, YuvEncoding encoding) {
  return {name, [=](const RgbImage& image) { return test::nv12_image(image, encoding); }, 10, 1.5};
}

FormatCase bayer(PixelFormat format, std::array<int, 4> channels) {
  return {std::string(to_string(format)),
          [=](const RgbImage& image) { return test::bayer_image(image, format, channels); }, 14,
          5.0};
}

FormatCase jpeg(const std::string& name, int subsampling) {
  return {name, [=](const RgbImage& image) { return test::jpeg_image(image, subsampling); }, 12,
          1.5};
}

INSTANTIATE_TEST_SUITE_P(
    Formats, EachFormat,
    testing::Combine(testing::Values(packed("yuyv_601_limited", PixelFormat::kYuyv, k601Limited),
                                     packed("yuyv_601_full", PixelFormat::kYuyv, k601Full),
                                     packed("uyvy_709_limited", PixelFormat::kUyvy, k709Limited),
                                     nv12("nv12_601_limited", k601Limited),
                                     nv12("nv12_601_full", k601Full),
                                     bayer(PixelFormat::kBayerRggb, {0, 1, 1, 2}),
                                     bayer(PixelFormat::kBayerGrbg, {1, 0, 2, 1}),
                                     bayer(PixelFormat::kBayerGbrg, {1, 2, 0, 1}),
                                     bayer(PixelFormat::kBayerBggr, {2, 1, 1, 0}),
                                     jpeg("jpeg_444", TJSAMP_444), jpeg("jpeg_422", TJSAMP_422),
                                     jpeg("jpeg_420", TJSAMP_420)),
                     testing::Values(std::pair{640, 360}, std::pair{1280, 720}, std::pair{960, 540},
                                     std::pair{2560, 1440}, std::pair{1928, 1086})),
    [](const auto& test) {
      return std::get<0>(test.param).name + "_" + std::to_string(std::get<1>(test.param).first);
    });

/// A constant image of RGB (200, 90, 40) must stay the same except for rounding.
TEST(PixelFormats, KeepAColour) {
  RgbImage image(640, 360);
  for (size_t i = 0; i < image.pixels.size(); i += 3) {
    image.pixels[i] = 200;
    image.pixels[i + 1] = 90;
    image.pixels[i + 2] = 40;
  }
  ImagePreprocessor preprocessor(camera_of_size(640, 360));
  constexpr size_t kMiddle = kNetworkPixels / 2 + kNetworkWidthPx / 2;
  for (const test::CameraImage& converted :
       {test::packed_image(image, PixelFormat::kYuyv, k601Limited),
        test::packed_image(image, PixelFormat::kUyvy, k601Full),
        test::nv12_image(image, k709Limited),
        test::bayer_image(image, PixelFormat::kBayerBggr, {2, 1, 1, 0}),
        test::jpeg_image(image, TJSAMP_420)}) {
    SCOPED_TRACE(to_string(converted.view.format));
    Planes planes(kNetworkImageSize);
    ASSERT_TRUE(preprocessor.run(converted.view, planes));
    EXPECT_NEAR(planes[kMiddle] + 128, 200, 2);
    EXPECT_NEAR(planes[kNetworkPixels + kMiddle] + 128, 90, 2);
    EXPECT_NEAR(planes[2 * kNetworkPixels + kMiddle] + 128, 40, 2);
  }
}

TEST(PixelFormats, AreBlackOutsideTheImage) {
  // The camera looks far down, so the horizon is above its image.
  const CameraModel camera = test::camera_at(0.0, 0.0, 1.5, 0.0, radians(65.0), radians(25.0));
  RgbImage white(640, 360);
  std::fill(white.pixels.begin(), white.pixels.end(), uint8_t{255});
  ImagePreprocessor preprocessor(camera);
  Planes wanted(kNetworkImageSize);
  ASSERT_TRUE(preprocessor.run(white.view(), wanted));
  ASSERT_EQ(wanted[kNetworkWidthPx / 2], kNetworkBlack);
  ASSERT_EQ(*std::ranges::max_element(wanted), 127);
  for (const test::CameraImage& converted :
       {test::packed_image(white, PixelFormat::kYuyv, k601Limited),
        test::nv12_image(white, k601Limited),
        test::bayer_image(white, PixelFormat::kBayerRggb, {0, 1, 1, 2}),
        test::jpeg_image(white, TJSAMP_444)}) {
    SCOPED_TRACE(to_string(converted.view.format));
    Planes planes(kNetworkImageSize);
    ASSERT_TRUE(preprocessor.run(converted.view, planes));
    EXPECT_EQ(planes, wanted);
  }
}

TEST(PixelFormats, RefuseADamagedJpeg) {
  const RgbImage image = colourful(640, 360);
  ImagePreprocessor preprocessor(camera_of_size(640, 360));
  Planes planes(kNetworkImageSize);
  test::CameraImage half = test::jpeg_image(image, TJSAMP_420);
  half.view.bytes_used /= 2;
  EXPECT_FALSE(preprocessor.run(half.view, planes));
  test::CameraImage noise = test::jpeg_image(image, TJSAMP_420);
  std::fill(noise.bytes.begin(), noise.bytes.end(), uint8_t{0x5A});
  EXPECT_FALSE(preprocessor.run(noise.view, planes));
  EXPECT_TRUE(preprocessor.run(test::jpeg_image(image, TJSAMP_420).view, planes))
      << "the next frame must work again";
}

/// Some USB cameras send such bytes with good images.
TEST(PixelFormats, IgnoreExtraBytesBeforeAMarkerOfAJpeg) {
  const test::RestartMarkers markers;
  const test::CameraImage plain = test::jpeg_image(colourful(640, 360), TJSAMP_422);
  ImagePreprocessor preprocessor(camera_of_size(640, 360));
  Planes wanted(kNetworkImageSize);
  ASSERT_TRUE(preprocessor.run(plain.view, wanted));
  for (const uint8_t marker : {test::restart_marker(4), test::kEndMarker}) {
    std::vector<uint8_t> bytes = plain.bytes;
    const size_t place = test::place_of(marker, bytes);
    ASSERT_LT(place, bytes.size());
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(place), 64, uint8_t{0});
    ImageView padded = plain.view;
    padded.planes[0].data = bytes.data();
    padded.bytes_used = bytes.size();
    Planes planes(kNetworkImageSize);
    const Status status = preprocessor.run(padded, planes);
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_EQ(planes, wanted);
    padded.bytes_used /= 2;
    EXPECT_FALSE(preprocessor.run(padded, planes));
  }
}

TEST(PixelFormats, RefuseAJpegOfTheWrongSize) {
  const RgbImage image = colourful(320, 180);
  test::CameraImage jpeg = test::jpeg_image(image, TJSAMP_420);
  jpeg.view.width = 640;
  jpeg.view.height = 360;
  Planes planes(kNetworkImageSize);
  const Status status = ImagePreprocessor(camera_of_size(640, 360)).run(jpeg.view, planes);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "JPEG frame: found 320x180 pixels, wanted 640x360 as in the calibration");
}

}  // namespace
}  // namespace bevloc
