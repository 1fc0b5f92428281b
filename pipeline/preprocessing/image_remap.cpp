#include "pipeline/preprocessing/image_remap.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "pipeline/preprocessing/format_remap.h"

namespace bevloc {
namespace {

/// YUYV or UYVY: two pixels in four bytes. `luma` is the offset of the first Y, `chroma` that of U.
YuvLayout packed_422(const ImageView& image, int luma, int chroma) {
  const auto [data, stride_bytes] = image.planes[0];
  return {.y = {data + luma, stride_bytes},
          .u = {data + chroma, stride_bytes},
          .v = {data + chroma + 2, stride_bytes},
          .y_step = 2,
          .chroma_step = 4,
          .chroma_shift_x = 1,
          .encoding = image.yuv};
}

YuvLayout nv12(const ImageView& image) {
  const auto [data, stride_bytes] = image.planes[1];
  return {.y = image.planes[0],
          .u = {data, stride_bytes},
          .v = {data + 1, stride_bytes},
          .chroma_step = 2,
          .chroma_shift_x = 1,
          .chroma_shift_y = 1,
          .encoding = image.yuv};
}

/// The largest reduction that leaves at least two decoded pixels for each network pixel.
int reduction_for(const Intrinsics& real) {
  const double largest = 0.5 * real_pixels_per_network_pixel(real);
  for (const int reduction : {8, 4, 2}) {
    if (real.width_px % reduction == 0 && reduction <= largest) return reduction;
  }
  return 1;
}

}  // namespace

ImagePreprocessor::MjpegReader::MjpegReader(const CameraModel& camera)
    : decoder(camera.intrinsics.width_px, camera.intrinsics.height_px,
              reduction_for(camera.intrinsics)),
      table(make_remap_table(
          resized(camera, decoder.reduced_width_px(), decoder.reduced_height_px()))) {}

ImagePreprocessor::ImagePreprocessor(const CameraModel& camera)
    : camera_(camera), table_(make_remap_table(camera)) {}

std::vector<uint8_t> ImagePreprocessor::shown_pixels() const {
  const auto taps = static_cast<size_t>(table_.taps);
  std::vector<uint8_t> shown;
  for (size_t pixel = 0; pixel < kNetworkPixels; ++pixel) {
    const auto columns = std::span(table_.weights).subspan(2 * taps * pixel, taps);
    shown.push_back(std::ranges::any_of(columns, [](uint16_t weight) { return weight > 0; }));
  }
  return shown;
}

Status ImagePreprocessor::run(const ImageView& image, std::span<int8_t> planes) {
  assert(planes.size() == kNetworkImageSize);
  const auto [width_px, height_px] =
      std::pair(camera_.intrinsics.width_px, camera_.intrinsics.height_px);
  if (image.width != width_px || image.height != height_px) {
    return fail("camera frame: found {}x{} pixels, wanted {}x{} as in the calibration", image.width,
                image.height, width_px, height_px);
  }
  const bool pairs_pixels =
      image.format == PixelFormat::kYuyv || image.format == PixelFormat::kUyvy;
  if (pairs_pixels && width_px % 2 != 0) {
    return fail("camera frame: found {} columns of {}, wanted an even number", width_px,
                to_string(image.format));
  }
  switch (image.format) {
    case PixelFormat::kRgb24:
      remap_rgb(image.rgb(), table_, planes.data());
      return {};
    case PixelFormat::kYuyv:
      remap_yuv(packed_422(image, 0, 1), table_, planes.data());
      return {};
    case PixelFormat::kUyvy:
      remap_yuv(packed_422(image, 1, 0), table_, planes.data());
      return {};
    case PixelFormat::kNv12:
      remap_yuv(nv12(image), table_, planes.data());
      return {};
    case PixelFormat::kMjpeg: {
      if (!mjpeg_) mjpeg_.emplace(camera_);
      const auto decoded = mjpeg_->decoder.decode(image);
      if (!decoded) return tl::unexpected(decoded.error());
      remap_yuv(*decoded, mjpeg_->table, planes.data());
      return {};
    }
    case PixelFormat::kBayerRggb:
    case PixelFormat::kBayerGrbg:
    case PixelFormat::kBayerGbrg:
    case PixelFormat::kBayerBggr:
      remap_bayer(image, table_, planes.data());
      return {};
  }
  return {};
}

}  // namespace bevloc
