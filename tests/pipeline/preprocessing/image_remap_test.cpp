#include "pipeline/preprocessing/image_remap.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/pipeline/preprocessing/surround_rig.h"

namespace bevloc {
namespace {

using Planes = std::vector<int8_t>;

CameraModel front_camera(int width_px = 640, int height_px = 360) {
  return resized(test::camera_at(1.5, 0.0, 1.5, 0.0, radians(65.0), 0.02), width_px, height_px);
}

/// Brightness of a smooth scene in a direction, per channel.
double brightness(const Eigen::Vector3d& ray, int channel) {
  const Eigen::Vector3d d = ray / ray.z();
  return 127.5 + 90.0 * std::sin(20.0 * d.x() + channel) * std::cos(25.0 * d.y() - channel);
}

RgbImage photograph(const Intrinsics& intrinsics) {
  RgbImage image(intrinsics.width_px, intrinsics.height_px);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const Eigen::Vector3d ray = intrinsics.ray(Eigen::Vector2d(u, v));
      for (int c = 0; c < 3; ++c) {
        image.row(v)[3 * u + c] = static_cast<uint8_t>(std::lround(brightness(ray, c)));
      }
    }
  }
  return image;
}

class ImageRemapSizes : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(ImageRemapSizes, ShowsTheSceneAsTheNetworkCameraSeesIt) {
  const auto [width, height] = GetParam();
  const CameraModel camera = front_camera(width, height);
  const RgbImage image = photograph(camera.intrinsics);
  Planes planes(kNetworkImageSize);
  ASSERT_TRUE(ImagePreprocessor(camera).run(image.view(), planes));

  const Intrinsics network = network_camera(camera).intrinsics;
  double worst = 0.0;
  for (int v = 0; v < kNetworkHeightPx; ++v) {
    for (int u = 2; u < kNetworkWidthPx - 2; ++u) {
      const Eigen::Vector3d ray = network.ray(Eigen::Vector2d(u, v));
      for (int c = 0; c < 3; ++c) {
        const int seen = planes[(c * kNetworkHeightPx + v) * kNetworkWidthPx + u] + 128;
        worst = std::max(worst, std::abs(seen - brightness(ray, c)));
      }
    }
  }
  EXPECT_LT(worst, 3.0);
}

TEST(ImageRemap, TheOwnBodyIsBlack) {
  CameraModel camera = front_camera();
  const RgbImage white = [] {
    RgbImage image(640, 360);
    std::ranges::fill(image.pixels, uint8_t{255});
    return image;
  }();
  std::vector<int8_t> whole(kNetworkImageSize);
  std::vector<int8_t> masked(kNetworkImageSize);
  ASSERT_TRUE(ImagePreprocessor(camera).run(white.view(), whole));
  camera.own_body_px = {{-1.0, 260.0}, {640.0, 260.0}, {640.0, 360.0}, {-1.0, 360.0}};
  ASSERT_TRUE(ImagePreprocessor(camera).run(white.view(), masked));
  const auto black = std::ranges::count(masked, kNetworkBlack);
  EXPECT_EQ(std::ranges::count(whole, kNetworkBlack), 0);
  EXPECT_GT(black, 3 * kNetworkWidthPx * 3);
  EXPECT_EQ(black % (3 * kNetworkWidthPx), 0) << "whole rows are black";
  EXPECT_EQ(masked[kNetworkImageSize / 6], 127) << "the middle stays";
}

INSTANTIATE_TEST_SUITE_P(Cameras, ImageRemapSizes,
                         ::testing::Values(std::pair{320, 180}, std::pair{480, 270},
                                           std::pair{640, 360}, std::pair{800, 450},
                                           std::pair{1280, 720}, std::pair{1920, 1080},
                                           std::pair{2560, 1440}, std::pair{3840, 2160}));

TEST(ImageRemap, AveragesDetailsBelowTheNetworkResolution) {
  const CameraModel camera = front_camera();
  RgbImage checkerboard(640, 360);
  for (int v = 0; v < 360; ++v) {
    for (int i = 0; i < 3 * 640; ++i) checkerboard.row(v)[i] = (v + i / 3) % 2 == 0 ? 255 : 0;
  }
  Planes planes(kNetworkImageSize);
  ASSERT_TRUE(ImagePreprocessor(camera).run(checkerboard.view(), planes));
  for (int v = 0; v < kNetworkHeightPx; ++v) {
    for (int u = 2; u < kNetworkWidthPx - 2; ++u) {
      EXPECT_NEAR(planes[v * kNetworkWidthPx + u], -0.5, 2.0) << "at " << u << ", " << v;
    }
  }
}

TEST(ImageRemap, KeepsAConstantExactly) {
  const CameraModel camera = front_camera();
  Planes planes(kNetworkImageSize);
  for (const int value : {0, 1, 77, 128, 255}) {
    RgbImage image(640, 360);
    std::fill(image.pixels.begin(), image.pixels.end(), static_cast<uint8_t>(value));
    ASSERT_TRUE(ImagePreprocessor(camera).run(image.view(), planes));
    for (int v = 0; v < kNetworkHeightPx; ++v) {
      for (int u = 2; u < kNetworkWidthPx - 2; ++u) {
        ASSERT_EQ(planes[v * kNetworkWidthPx + u], value - 128);
      }
    }
  }
}

TEST(ImageRemap, DoesNotMixChannels) {
  const CameraModel camera = front_camera();
  RgbImage image(640, 360);
  for (size_t i = 0; i < image.pixels.size(); i += 3) {
    image.pixels[i] = 10;
    image.pixels[i + 1] = 100;
    image.pixels[i + 2] = 200;
  }
  Planes planes(kNetworkImageSize);
  ASSERT_TRUE(ImagePreprocessor(camera).run(image.view(), planes));
  constexpr size_t kPlane = kNetworkImageSize / 3;
  constexpr size_t kMiddle = kPlane / 2 + kNetworkWidthPx / 2;
  EXPECT_EQ(planes[kMiddle], 10 - 128);
  EXPECT_EQ(planes[kPlane + kMiddle], 100 - 128);
  EXPECT_EQ(planes[2 * kPlane + kMiddle], 200 - 128);
}

TEST(ImageRemap, IsBlackOutsideTheImage) {
  // The camera looks far down, so the horizon is above its image.
  const CameraModel camera = test::camera_at(0.0, 0.0, 1.5, 0.0, radians(65.0), radians(40.0));
  RgbImage white(640, 360);
  std::fill(white.pixels.begin(), white.pixels.end(), uint8_t{255});
  Planes planes(kNetworkImageSize);
  ASSERT_TRUE(ImagePreprocessor(camera).run(white.view(), planes));
  EXPECT_EQ(planes[kNetworkWidthPx / 2], kNetworkBlack);
}

TEST(ImageRemap, RespectsTheStride) {
  const CameraModel camera = front_camera();
  const RgbImage image = photograph(camera.intrinsics);
  constexpr std::ptrdiff_t kStride = 3 * 640 + 50;
  std::vector<uint8_t> padded(kStride * 360, 99);
  for (int v = 0; v < 360; ++v) std::copy_n(image.row(v), 3 * 640, &padded[v * kStride]);
  Planes expected(kNetworkImageSize);
  Planes planes(kNetworkImageSize);
  ImagePreprocessor preprocessor(camera);
  ASSERT_TRUE(preprocessor.run(image.view(), expected));
  ASSERT_TRUE(preprocessor.run(RgbView{padded.data(), 640, 360, kStride}, planes));
  EXPECT_EQ(planes, expected);
}

TEST(ImageRemap, RefusesAFrameOfTheWrongSize) {
  ImagePreprocessor preprocessor(front_camera());
  const RgbImage image(1280, 720);
  Planes planes(kNetworkImageSize);
  const Status status = preprocessor.run(image.view(), planes);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "camera frame: found 1280x720 pixels, wanted 640x360 as in the calibration");
}

/// The last pixel of a row would have no V.
TEST(ImageRemap, RefusesAnOddNumberOfColumnsInPairs) {
  CameraModel camera = front_camera();
  camera.intrinsics.width_px = 641;
  const std::vector<uint8_t> row_pairs(2 * 642 * 360);
  ImageView image;
  image.format = PixelFormat::kUyvy;
  image.width = 641;
  image.height = 360;
  image.planes[0] = {row_pairs.data(), 2 * 642};
  Planes planes(kNetworkImageSize);
  ImagePreprocessor preprocessor(camera);
  const Status status = preprocessor.run(image, planes);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "camera frame: found 641 columns of uyvy, wanted an even number");
}

}  // namespace
}  // namespace bevloc
