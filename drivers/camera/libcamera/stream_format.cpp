#include "drivers/camera/libcamera/stream_format.h"

#include <cassert>
#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <libcamera/formats.h>

namespace bevloc::drivers::libcam {
namespace {

std::string offered_formats(const libcamera::StreamFormats& formats) {
  std::vector<std::string> offers;
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    std::string offer = format.toString();
    for (const libcamera::Size& size : formats.sizes(format)) {
      offer += fmt::format(" {}x{}", size.width, size.height);
    }
    offers.push_back(offer);
  }
  return fmt::format("{}", fmt::join(offers, "; "));
}

/// libcamera uses the names of DRM, in which BGR888 has the byte order of our rgb24.
libcamera::PixelFormat libcamera_format(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return libcamera::formats::BGR888;
    case PixelFormat::kYuyv:
      return libcamera::formats::YUYV;
    case PixelFormat::kUyvy:
      return libcamera::formats::UYVY;
    case PixelFormat::kNv12:
      return libcamera::formats::NV12;
    case PixelFormat::kBayerRggb:
      return libcamera::formats::SRGGB8;
    case PixelFormat::kBayerGrbg:
      return libcamera::formats::SGRBG8;
    case PixelFormat::kBayerGbrg:
      return libcamera::formats::SGBRG8;
    case PixelFormat::kBayerBggr:
      return libcamera::formats::SBGGR8;
    case PixelFormat::kMjpeg:
      return libcamera::formats::MJPEG;
  }
  assert(false);
  return {};
}

}  // namespace

YuvEncoding yuv_encoding(const libcamera::StreamConfiguration& stream) {
  if (!stream.colorSpace) return {};
  using libcamera::ColorSpace;
  return {stream.colorSpace->ycbcrEncoding == ColorSpace::YcbcrEncoding::Rec709 ? YuvMatrix::kBt709
                                                                                : YuvMatrix::kBt601,
          stream.colorSpace->range == ColorSpace::Range::Full};
}

Result<PixelFormat> choose_format(libcamera::CameraConfiguration& configuration,
                                  const DeviceCameraConfig& config) {
  libcamera::StreamConfiguration& stream = configuration.at(0);
  const libcamera::StreamFormats offered = stream.formats();
  std::vector<std::string_view> wanted;
  for (const PixelFormat format : config.formats) {
    wanted.push_back(to_string(format));
    const libcamera::PixelFormat pixel_format = libcamera_format(format);
    const libcamera::Size size(static_cast<unsigned>(config.width_px),
                               static_cast<unsigned>(config.height_px));
    stream.pixelFormat = pixel_format;
    stream.size = size;
    stream.bufferCount = static_cast<unsigned>(config.buffers);
    const bool is_valid = configuration.validate() != libcamera::CameraConfiguration::Invalid;
    if (is_valid && stream.pixelFormat == pixel_format && stream.size == size) return format;
  }
  return fail("offers {}; wanted {} {}x{}", offered_formats(offered), fmt::join(wanted, " or "),
              config.width_px, config.height_px);
}

}  // namespace bevloc::drivers::libcam
