// A borrowed image in the pixel format that a camera delivers.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/image.h"

namespace bevloc {

/// The memory layout of an image. In YUYV and UYVY two neighbouring columns share their chroma, in
/// NV12 two columns and two rows. Bayer formats have 8 bits per pixel and are named by the top left
/// two by two pixels, row by row.
enum class PixelFormat : uint8_t {
  kRgb24,
  kYuyv,
  kUyvy,
  kNv12,
  kBayerRggb,
  kBayerGrbg,
  kBayerGbrg,
  kBayerBggr,
  kMjpeg,  ///< each frame is one JPEG (JFIF) file
};

struct NamedPixelFormat {
  std::string_view name;
  PixelFormat format;
};

/// The names of the formats in configuration files and messages.
inline constexpr std::array<NamedPixelFormat, 9> kPixelFormats{{
    {"rgb24", PixelFormat::kRgb24},
    {"yuyv", PixelFormat::kYuyv},
    {"uyvy", PixelFormat::kUyvy},
    {"nv12", PixelFormat::kNv12},
    {"bayer_rggb", PixelFormat::kBayerRggb},
    {"bayer_grbg", PixelFormat::kBayerGrbg},
    {"bayer_gbrg", PixelFormat::kBayerGbrg},
    {"bayer_bggr", PixelFormat::kBayerBggr},
    {"mjpeg", PixelFormat::kMjpeg},
}};

constexpr std::string_view to_string(PixelFormat format) {
  for (const NamedPixelFormat& known : kPixelFormats) {
    if (known.format == format) return known.name;
  }
  return "unknown";
}

/// Position of the first red pixel of a Bayer image: row and column are 0 or 1.
struct RedPixel {
  int row;
  int col;
};

constexpr RedPixel red_of(PixelFormat format) {
  const bool is_below = format == PixelFormat::kBayerGbrg || format == PixelFormat::kBayerBggr;
  const bool is_right = format == PixelFormat::kBayerGrbg || format == PixelFormat::kBayerBggr;
  return {is_below ? 1 : 0, is_right ? 1 : 0};
}

/// How YUV was computed from RGB (ITU-R BT.601-7, BT.709-6). Limited range: black is 16, white 235.
enum class YuvMatrix : uint8_t { kBt601, kBt709 };
struct YuvEncoding {
  YuvMatrix matrix = YuvMatrix::kBt601;
  bool full_range = false;

  bool operator==(const YuvEncoding&) const = default;
};

struct ImagePlane {
  const uint8_t* data = nullptr;
  std::ptrdiff_t stride_bytes = 0;
};

/// An image in memory that it does not own. NV12 has two planes, every other format has one. The
/// plane of an MJPEG image is the JPEG file and has no stride.
struct ImageView {
  PixelFormat format = PixelFormat::kRgb24;
  int width = 0;
  int height = 0;
  std::array<ImagePlane, 2> planes;
  size_t bytes_used = 0;  ///< bytes that the device wrote; for MJPEG the size of the file
  YuvEncoding yuv;        ///< only meaningful for YUYV, UYVY and NV12

  ImageView() = default;
  /// Implicit, so that an RGB image can be passed wherever a camera image is expected.
  ImageView(const RgbView& rgb)
      : width(rgb.width), height(rgb.height), planes{{{rgb.data, rgb.stride_bytes}, {}}} {}

  /// Requires format kRgb24.
  RgbView rgb() const {
    assert(format == PixelFormat::kRgb24);
    return {planes[0].data, width, height, planes[0].stride_bytes};
  }
};

}  // namespace bevloc
