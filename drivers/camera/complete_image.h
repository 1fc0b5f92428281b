// Checks whether an image from a device is complete.
#pragma once

#include <cstdint>
#include <span>

#include "common/image_view.h"

namespace bevloc::drivers {

/// Whether a JPEG file begins with the marker SOI and ends with EOI (ITU-T T.81, B.1.1.3). Cameras
/// may append zeros.
inline bool is_complete_jpeg(std::span<const uint8_t> file) {
  constexpr uint8_t kMarker = 0xFF;
  constexpr uint8_t kStartOfImage = 0xD8;
  constexpr uint8_t kEndOfImage = 0xD9;
  while (!file.empty() && file.back() == 0) file = file.first(file.size() - 1);
  return file.size() > 4 && file[0] == kMarker && file[1] == kStartOfImage &&
         file[file.size() - 2] == kMarker && file.back() == kEndOfImage;
}

/// Returns the smallest number of bytes of a complete image with this stride and height, or 0 for
/// MJPEG.
inline size_t min_image_bytes(const ImageView& image) {
  if (image.format == PixelFormat::kMjpeg) return 0;
  const auto stride_bytes = static_cast<size_t>(image.planes[0].stride_bytes);
  const auto rows = static_cast<size_t>(image.height);
  const size_t chroma_rows = image.format == PixelFormat::kNv12 ? (rows + 1) / 2 : 0;
  return stride_bytes * (rows + chroma_rows);
}

/// Whether the device wrote enough bytes. For MJPEG, whether the file has both its markers.
inline bool is_complete(const ImageView& image) {
  if (image.format == PixelFormat::kMjpeg) {
    return is_complete_jpeg({image.planes[0].data, image.bytes_used});
  }
  return image.bytes_used >= min_image_bytes(image);
}

}  // namespace bevloc::drivers
