// The sizes of the planes of an image, without the padding between their rows.
#pragma once

#include <cstddef>

#include "common/image_view.h"

namespace bevloc {

struct PlaneSize {
  size_t row_bytes = 0;
  int rows = 0;

  size_t bytes() const { return row_bytes * static_cast<size_t>(rows); }
};

/// The size of planes[0] or planes[1]. A plane that the format lacks has no rows. If two columns or
/// rows share their chroma, their number is rounded up to an even one. An MJPEG image is one row.
constexpr PlaneSize plane_size(const ImageView& image, size_t plane) {
  const auto width = static_cast<size_t>(image.width);
  const size_t even_width = (width + 1) & ~size_t{1};
  if (plane == 1) {
    if (image.format != PixelFormat::kNv12) return {};
    return {even_width, (image.height + 1) / 2};
  }
  switch (image.format) {
    case PixelFormat::kRgb24:
      return {3 * width, image.height};
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
      return {2 * even_width, image.height};
    case PixelFormat::kMjpeg:
      return {image.bytes_used, 1};
    default:  // luma, or Bayer
      return {width, image.height};
  }
}

}  // namespace bevloc
