// Tests V4L2's names, colour encodings and image layouts, and the check for complete images.
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/camera/complete_image.h"
#include "drivers/camera/v4l2/controls.h"
#include "drivers/camera/v4l2/pixel_formats.h"

namespace bevloc::drivers::v4l2 {
namespace {

TEST(V4l2Formats, EveryFormatHasAFourccOfItsOwn) {
  std::set<uint32_t> seen;
  for (const NamedPixelFormat& format : kPixelFormats) seen.insert(fourcc_of(format.format));
  EXPECT_EQ(seen.size(), kPixelFormats.size());
  EXPECT_EQ(fourcc_name(fourcc_of(PixelFormat::kMjpeg)), "MJPG");
  EXPECT_EQ(fourcc_name(fourcc_of(PixelFormat::kNv12)), "NV12");
}

TEST(V4l2Formats, InterlacedImagesAreNotProgressive) {
  EXPECT_TRUE(is_progressive(V4L2_FIELD_NONE));
  EXPECT_TRUE(is_progressive(V4L2_FIELD_ANY)) << "a driver that knows no field orders";
  for (const uint32_t field : {V4L2_FIELD_TOP, V4L2_FIELD_BOTTOM, V4L2_FIELD_INTERLACED,
                               V4L2_FIELD_SEQ_TB, V4L2_FIELD_SEQ_BT, V4L2_FIELD_ALTERNATE,
                               V4L2_FIELD_INTERLACED_TB, V4L2_FIELD_INTERLACED_BT}) {
    EXPECT_FALSE(is_progressive(field)) << field_name(field);
    EXPECT_NE(field_name(field), field_name(V4L2_FIELD_NONE));
    EXPECT_NE(field_name(field), "unknown");
  }
}

TEST(V4l2Formats, AControlThatChangesTheLayoutIsFound) {
  v4l2_pix_format negotiated{};
  negotiated.pixelformat = V4L2_PIX_FMT_SRGGB8;
  negotiated.width = 640;
  negotiated.height = 360;
  negotiated.bytesperline = 640;
  negotiated.field = V4L2_FIELD_NONE;
  EXPECT_TRUE(check_same_layout(negotiated, negotiated));
  v4l2_pix_format flipped = negotiated;
  flipped.pixelformat = V4L2_PIX_FMT_SGBRG8;
  const Status changed = check_same_layout(negotiated, flipped);
  ASSERT_FALSE(changed);
  const std::string& message = changed.error().message;
  EXPECT_NE(message.find("found the format GBRG 640x360"), std::string::npos) << message;
  EXPECT_NE(message.find("wanted RGGB 640x360"), std::string::npos) << message;
  v4l2_pix_format rotated = negotiated;
  std::swap(rotated.width, rotated.height);
  EXPECT_FALSE(check_same_layout(negotiated, rotated));
  v4l2_pix_format padded = negotiated;
  padded.bytesperline += 64;
  EXPECT_FALSE(check_same_layout(negotiated, padded));
  v4l2_pix_format interlaced = negotiated;
  interlaced.field = V4L2_FIELD_INTERLACED;
  EXPECT_FALSE(check_same_layout(negotiated, interlaced));
  interlaced.field = V4L2_FIELD_ANY;
  EXPECT_TRUE(check_same_layout(negotiated, interlaced)) << "counts as progressive";
}

TEST(V4l2Formats, ReadsTheColourEncodingOfTheDevice) {
  v4l2_pix_format pixels{};
  pixels.pixelformat = V4L2_PIX_FMT_YUYV;
  EXPECT_EQ(yuv_encoding(pixels), (YuvEncoding{YuvMatrix::kBt601, false})) << "the usual default";
  pixels.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  EXPECT_EQ(yuv_encoding(pixels), (YuvEncoding{YuvMatrix::kBt601, true}));
  pixels.colorspace = V4L2_COLORSPACE_REC709;
  pixels.quantization = V4L2_QUANTIZATION_DEFAULT;
  EXPECT_EQ(yuv_encoding(pixels), (YuvEncoding{YuvMatrix::kBt709, false}));
  pixels.ycbcr_enc = V4L2_YCBCR_ENC_601;
  EXPECT_EQ(yuv_encoding(pixels), (YuvEncoding{YuvMatrix::kBt601, false}));
}

TEST(V4l2Formats, TheChromaOfNv12FollowsItsPaddedLuma) {
  v4l2_pix_format pixels{};
  pixels.width = 60;
  pixels.height = 40;
  pixels.bytesperline = 64;
  const std::vector<uint8_t> memory(64 * 60);
  const ImageView view = view_of(PixelFormat::kNv12, pixels, memory.data());
  EXPECT_EQ(view.planes[0].stride_bytes, 64);
  EXPECT_EQ(view.planes[1].data - view.planes[0].data, 64 * 40);
  EXPECT_EQ(view.planes[1].stride_bytes, 64);
  EXPECT_EQ(min_image_bytes(view), 64U * 60U);
}

TEST(V4l2Controls, AreNamedAsV4l2CtlDoes) {
  EXPECT_EQ(control_word("Exposure Time, Absolute"), "exposure_time_absolute");
  EXPECT_EQ(control_word("White Balance, Automatic "), "white_balance_automatic");
  EXPECT_EQ(control_word("Gain"), "gain");
}

TEST(CompleteImage, OfNv12HasItsChroma) {
  ImageView view;
  view.format = PixelFormat::kNv12;
  view.height = 40;
  view.planes[0].stride_bytes = 64;
  view.bytes_used = 64 * 40;
  EXPECT_FALSE(is_complete(view)) << "only luma";
  view.bytes_used = 64 * 60;
  EXPECT_TRUE(is_complete(view));
  view.height = 41;
  EXPECT_EQ(min_image_bytes(view), 64U * (41U + 21U)) << "the last row has chroma of its own";
  view.height = 40;
  view.format = PixelFormat::kYuyv;
  view.bytes_used = 64 * 40 - 1;
  EXPECT_FALSE(is_complete(view));
  view.bytes_used = 64 * 40;
  EXPECT_TRUE(is_complete(view));
}

TEST(CompleteImage, OfMjpegHasBothMarkers) {
  EXPECT_TRUE(is_complete_jpeg(std::vector<uint8_t>{0xFF, 0xD8, 1, 2, 0xFF, 0xD9}));
  EXPECT_TRUE(is_complete_jpeg(std::vector<uint8_t>{0xFF, 0xD8, 1, 2, 0xFF, 0xD9, 0, 0}))
      << "padded";
  EXPECT_FALSE(is_complete_jpeg(std::vector<uint8_t>{0xFF, 0xD8, 1, 2, 3, 4})) << "cut off";
  EXPECT_FALSE(is_complete_jpeg(std::vector<uint8_t>{1, 2, 3, 4, 0xFF, 0xD9})) << "no beginning";
  EXPECT_FALSE(is_complete_jpeg({}));
}

}  // namespace
}  // namespace bevloc::drivers::v4l2
