// Whether a picture from a device arrived whole.
#pragma once

#include <cstdint>
#include <span>

#include "common/image_view.h"

namespace bevloc::drivers {

/// Begins with the marker SOI and ends with EOI (ITU-T T.81, B.1.1.3); cameras may pad with zeros.
inline bool is_whole_jpeg(std::span<const uint8_t> file) {
  constexpr uint8_t kMarker = 0xFF;
  constexpr uint8_t kStartOfImage = 0xD8;
  constexpr uint8_t kEndOfImage = 0xD9;
  while (!file.empty() && file.back() == 0) file = file.first(file.size() - 1);
  return file.size() > 4 && file[0] == kMarker && file[1] == kStartOfImage &&
         file[file.size() - 2] == kMarker && file.back() == kEndOfImage;
}

/// The bytes that a whole picture with rows of this length has at least; 0 for MJPEG.
inline size_t picture_bytes(const ImageView& picture) {
  if (picture.format == PixelFormat::kMjpeg) return 0;
  const auto plane =
      static_cast<size_t>(picture.planes[0].stride_bytes) * static_cast<size_t>(picture.height);
  return picture.format == PixelFormat::kNv12 ? plane + plane / 2 : plane;
}

/// By what the device says it filled, and by a JPEG file's own marks.
inline bool is_whole(const ImageView& picture) {
  if (picture.format == PixelFormat::kMjpeg) {
    return is_whole_jpeg({picture.planes[0].data, picture.bytes_used});
  }
  return picture.bytes_used >= picture_bytes(picture);
}

}  // namespace bevloc::drivers
