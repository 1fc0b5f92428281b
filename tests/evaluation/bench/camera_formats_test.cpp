#include "evaluation/bench/camera_formats.h"

#include <gtest/gtest.h>

#include "pipeline/preprocessing/image_remap.h"
#include "sim/sim_rig.h"

namespace bevloc::bench {
namespace {

/// An image with smooth colours, so that the chroma subsampling of a format changes little.
RgbImage smooth_image(const CameraModel& camera) {
  RgbImage image(camera.intrinsics.width_px, camera.intrinsics.height_px);
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      uint8_t* pixel = image.row(row) + 3 * col;
      pixel[0] = static_cast<uint8_t>(60 + 120 * col / image.width);
      pixel[1] = static_cast<uint8_t>(80 + 100 * row / image.height);
      pixel[2] = static_cast<uint8_t>(180 - 90 * col / image.width);
    }
  }
  return image;
}

class CameraFormat : public testing::TestWithParam<PixelFormat> {};

TEST_P(CameraFormat, GivesTheSameNetworkInput) {
  const CameraModel camera = sim::nominal_rig().cameras[1];
  const RgbImage image = smooth_image(camera);
  ImagePreprocessor preprocessor(camera);
  std::vector<int8_t> expected(kNetworkImageSize);
  ASSERT_TRUE(preprocessor.run(ImageView(image.view()), expected));
  const auto converted = convert(image, GetParam());
  ASSERT_TRUE(converted) << converted.error().message;
  std::vector<int8_t> found(kNetworkImageSize);
  const Status status = preprocessor.run(converted->view, found);
  ASSERT_TRUE(status) << status.error().message;
  double sum = 0.0;
  for (size_t i = 0; i < found.size(); ++i) sum += std::abs(found[i] - expected[i]);
  EXPECT_LT(sum / static_cast<double>(found.size()), 2.0);
}

std::string format_name(const testing::TestParamInfo<PixelFormat>& tested) {
  return std::string(to_string(tested.param));
}
INSTANTIATE_TEST_SUITE_P(All, CameraFormat, testing::ValuesIn(kBenchFormats), format_name);

TEST(CameraFormats, RefusesAnOddWidth) {
  FramesetImages images;
  for (RgbImage& image : images) image = RgbImage(640, 360);
  images[4] = RgbImage(641, 360);
  const auto converted = convert(images, PixelFormat::kNv12);
  ASSERT_FALSE(converted);
  EXPECT_EQ(converted.error().message,
            "back: found images of 641 x 360 pixels, wanted an even width and height");
}

}  // namespace
}  // namespace bevloc::bench
