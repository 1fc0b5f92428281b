#include "evaluation/bench/camera_formats.h"

#include <algorithm>
#include <cassert>

#include <turbojpeg.h>

namespace bevloc::bench {
namespace {

struct Yuv {
  uint8_t y;
  uint8_t u;
  uint8_t v;
};

uint8_t to_byte(double value) {
  return static_cast<uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
}

/// Converts a pixel by BT.601 with limited range.
Yuv yuv_of(const uint8_t* rgb) {
  const double red = rgb[0];
  const double green = rgb[1];
  const double blue = rgb[2];
  const double luma = 0.299 * red + 0.587 * green + 0.114 * blue;
  return {to_byte(16.0 + luma * 219.0 / 255.0),
          to_byte(128.0 + (blue - luma) / 1.772 * 224.0 / 255.0),
          to_byte(128.0 + (red - luma) / 1.402 * 224.0 / 255.0)};
}

ConvertedImage with_size(const RgbImage& image, PixelFormat format, size_t bytes) {
  ConvertedImage converted;
  converted.bytes.resize(bytes);
  converted.view.format = format;
  converted.view.width = image.width;
  converted.view.height = image.height;
  return converted;
}

/// The chroma of each pair of pixels is that of the left pixel.
ConvertedImage packed_yuv(const RgbImage& image, PixelFormat format) {
  const size_t stride = 2 * static_cast<size_t>(image.width);
  ConvertedImage converted = with_size(image, format, stride * image.height);
  const int luma = format == PixelFormat::kUyvy ? 1 : 0;
  for (int row = 0; row < image.height; ++row) {
    uint8_t* out = converted.bytes.data() + stride * row;
    for (int col = 0; col < image.width; ++col) {
      const Yuv yuv = yuv_of(image.row(row) + 3 * col);
      out[2 * col + luma] = yuv.y;
      if (col % 2 != 0) continue;
      out[2 * col + 1 - luma] = yuv.u;
      out[2 * col + 3 - luma] = yuv.v;
    }
  }
  converted.view.planes[0] = {converted.bytes.data(), static_cast<std::ptrdiff_t>(stride)};
  return converted;
}

/// The chroma of each block of 2 x 2 pixels is that of the top left pixel.
ConvertedImage nv12(const RgbImage& image) {
  const auto width = static_cast<size_t>(image.width);
  const size_t luma_bytes = width * image.height;
  ConvertedImage converted = with_size(image, PixelFormat::kNv12, luma_bytes + luma_bytes / 2);
  uint8_t* const chroma = converted.bytes.data() + luma_bytes;
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      const Yuv yuv = yuv_of(image.row(row) + 3 * col);
      converted.bytes[width * row + col] = yuv.y;
      if (col % 2 != 0 || row % 2 != 0) continue;
      chroma[width * (row / 2) + col] = yuv.u;
      chroma[width * (row / 2) + col + 1] = yuv.v;
    }
  }
  const auto stride = static_cast<std::ptrdiff_t>(width);
  converted.view.planes = {{{converted.bytes.data(), stride}, {chroma, stride}}};
  return converted;
}

ConvertedImage bayer_rggb(const RgbImage& image) {
  constexpr int kChannel[2][2] = {{0, 1}, {1, 2}};
  const auto width = static_cast<size_t>(image.width);
  ConvertedImage converted = with_size(image, PixelFormat::kBayerRggb, width * image.height);
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      converted.bytes[width * row + col] = image.row(row)[3 * col + kChannel[row % 2][col % 2]];
    }
  }
  converted.view.planes[0] = {converted.bytes.data(), static_cast<std::ptrdiff_t>(width)};
  return converted;
}

Result<ConvertedImage> jpeg(const RgbImage& image) {
  constexpr int kQuality = 90;
  unsigned char* file = nullptr;
  unsigned long bytes = 0;
  const tjhandle compressor = tjInitCompress();
  const int failed = tjCompress2(compressor, image.pixels.data(), image.width, 0, image.height,
                                 TJPF_RGB, &file, &bytes, TJSAMP_422, kQuality, 0);
  ConvertedImage converted = with_size(image, PixelFormat::kMjpeg, failed == 0 ? bytes : 0);
  std::copy_n(file, converted.bytes.size(), converted.bytes.data());
  converted.view.planes[0].data = converted.bytes.data();
  converted.view.bytes_used = converted.bytes.size();
  tjFree(file);
  const std::string reason = failed == 0 ? "" : tjGetErrorStr2(compressor);
  tjDestroy(compressor);
  if (failed != 0) return fail("libjpeg-turbo cannot compress an image: {}", reason);
  return converted;
}

}  // namespace

Result<ConvertedImage> convert(const RgbImage& image, PixelFormat format) {
  assert(image.width % 2 == 0 && image.height % 2 == 0);
  switch (format) {
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
      return packed_yuv(image, format);
    case PixelFormat::kNv12:
      return nv12(image);
    case PixelFormat::kMjpeg:
      return jpeg(image);
    default:
      assert(format == PixelFormat::kBayerRggb);
      return bayer_rggb(image);
  }
}

Result<ConvertedImages> convert(const FramesetImages& images, PixelFormat format) {
  ConvertedImages converted;
  for (size_t camera = 0; camera < converted.size(); ++camera) {
    const RgbImage& image = images[camera];
    if (image.width % 2 != 0 || image.height % 2 != 0) {
      return fail("{}: found images of {} x {} pixels, wanted an even width and height",
                  kCameraNames[camera], image.width, image.height);
    }
    auto one = convert(image, format);
    if (!one) return tl::unexpected(one.error());
    converted[camera] = std::move(*one);
  }
  return converted;
}

double bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return 3.0;
    case PixelFormat::kNv12:
      return 1.5;
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
    case PixelFormat::kMjpeg:  // 4:2:2
      return 2.0;
    default:
      return 1.0;
  }
}

}  // namespace bevloc::bench
