#include "firmware/recording/image_memory.h"

#include <cstring>

namespace bevloc::firmware {
namespace {

size_t row_bytes(const ImageView& image) {
  const auto width = static_cast<size_t>(image.width);
  switch (image.format) {
    case PixelFormat::kRgb24:
      return 3 * width;
    case PixelFormat::kYuyv:
    case PixelFormat::kUyvy:
      return 2 * ((width + 1) & ~size_t{1});
    default:
      return width;
  }
}

/// Copies rows and returns the place behind the last one.
uint8_t* copy_rows(const ImagePlane& plane, size_t bytes, int rows, uint8_t* target) {
  for (int row = 0; row < rows; ++row, target += bytes) {
    std::memcpy(target, plane.data + row * plane.stride_bytes, bytes);
  }
  return target;
}

}  // namespace

std::optional<RecordedImage> ImageMemory::copy(const drivers::Frame& frame, Time now) {
  const ImageView& source = frame.image();
  const bool mjpeg = source.format == PixelFormat::kMjpeg;
  const bool nv12 = source.format == PixelFormat::kNv12;
  const size_t row = mjpeg ? source.bytes_used : row_bytes(source);
  const int chroma_rows = nv12 ? (source.height + 1) / 2 : 0;
  const int rows = mjpeg ? 1 : source.height;
  const size_t chroma_row = nv12 ? (row + 1) & ~size_t{1} : 0;
  const size_t needed =
      row * static_cast<size_t>(rows) + chroma_row * static_cast<size_t>(chroma_rows);
  if (needed > bytes_) return std::nullopt;
  RecordedImage copy{frame.camera,    now,   frame.time, frame.exposure, frame.sequence,
                     pool_->borrow(), source};
  if (!copy.memory) return std::nullopt;
  uint8_t* const memory = pool_->image(copy.memory).pixels.data();
  uint8_t* const behind = copy_rows(source.planes[0], row, rows, memory);
  copy_rows(source.planes[1], chroma_row, chroma_rows, behind);
  copy.image.bytes_used = needed;
  copy.image.planes[0] = {memory, static_cast<std::ptrdiff_t>(row)};
  if (nv12) copy.image.planes[1] = {behind, static_cast<std::ptrdiff_t>(chroma_row)};
  return copy;
}

}  // namespace bevloc::firmware
