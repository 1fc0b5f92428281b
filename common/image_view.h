// A borrowed picture in the format that a camera delivers.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/image.h"

namespace bevloc {

/// What the bytes of a picture mean. YUV formats share the chroma of neighbours: YUYV and UYVY that
/// of two columns, NV12 that of two columns and two rows. Bayer formats are named by the top left
/// two by two pixels, row by row, 8 bits each.
enum class PixelFormat : uint8_t {
  kRgb24,
  kYuyv,
  kUyvy,
  kNv12,
  kBayerRggb,
  kBayerGrbg,
  kBayerGbrg,
  kBayerBggr,
  kMjpeg,  ///< each frame one JPEG (JFIF) file
};

struct NamedPixelFormat {
  std::string_view name;
  PixelFormat format;
};

/// As configuration files and messages call them.
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

/// How YUV was made from RGB (ITU-R BT.601-7, BT.709-6). Limited range: black is 16, white 235.
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

/// A picture in somebody else's memory. NV12 has two planes, every other format one; of MJPEG the
/// plane is the file and has no stride.
struct ImageView {
  PixelFormat format = PixelFormat::kRgb24;
  int width = 0;
  int height = 0;
  std::array<ImagePlane, 2> planes;
  size_t bytes_used = 0;  ///< that the device filled; of MJPEG the file's
  YuvEncoding yuv;        ///< of YUYV, UYVY and NV12 only

  ImageView() = default;
  /// Not explicit: an RGB image is one of the things that a camera's picture may be.
  ImageView(const RgbView& rgb)
      : width(rgb.width), height(rgb.height), planes{{{rgb.data, rgb.stride_bytes}, {}}} {}

  /// Of an RGB picture.
  RgbView rgb() const {
    assert(format == PixelFormat::kRgb24);
    return {planes[0].data, width, height, planes[0].stride_bytes};
  }
};

}  // namespace bevloc
