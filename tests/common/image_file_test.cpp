#include "common/image_file.h"

#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "common/files.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

class ImageFile : public testing::Test {
 protected:
  std::string path(const char* name) const { return (folder_ / name).string(); }

  /// Writes a smooth image with OpenCV. Each pixel has another value.
  std::string written_by_opencv(const char* name, int type) const {
    cv::Mat image(kHeight, kWidth, type);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        uint8_t* const pixel = image.ptr(v) + u * image.elemSize();
        const uint8_t bgra[] = {static_cast<uint8_t>(40 + 3 * u), static_cast<uint8_t>(90 + 5 * v),
                                static_cast<uint8_t>(200 - 2 * u - v), 255};
        for (size_t i = 0; i < image.elemSize(); ++i) pixel[i] = bgra[i];
      }
    }
    cv::imwrite(path(name), image);
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
  for (const int type : {CV_8UC3, CV_8UC4}) {
    RgbImage image(kWidth, kHeight);
    const Status read = read_image(written_by_opencv("a.png", type), image);
    ASSERT_TRUE(read) << read.error().message;
    expect_smooth_image(image, 0);
  }
}

TEST_F(ImageFile, ReadsGreyPngAsRgb) {
  RgbImage image(kWidth, kHeight);
  ASSERT_TRUE(read_image(written_by_opencv("grey.png", CV_8UC1), image));
  for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(image.row(3)[3 * 5 + channel], 40 + 15);
}

TEST_F(ImageFile, ReadsJpeg) {
  RgbImage image(kWidth, kHeight);
  const Status read = read_image(written_by_opencv("a.jpg", CV_8UC3), image);
  ASSERT_TRUE(read) << read.error().message;
  expect_smooth_image(image, 8);
}

TEST_F(ImageFile, WritesWhatItReads) {
  RgbImage image(kWidth, kHeight);
  ASSERT_TRUE(read_image(written_by_opencv("a.png", CV_8UC3), image));
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

  for (const char* name : {"cut.png", "cut.jpg"}) {
    const std::string whole = read_file(written_by_opencv(name, CV_8UC3)).value();
    ASSERT_TRUE(write_file(path(name), whole.substr(0, whole.size() * 3 / 4)));
    EXPECT_THAT(error_of(name), AllOf(HasSubstr(name), HasSubstr("found a damaged"))) << name;
  }
  EXPECT_FALSE(write_png(image.view(), path("no/such/folder.png")));
}

}  // namespace
}  // namespace bevloc
