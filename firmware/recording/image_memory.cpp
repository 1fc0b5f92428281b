#include "firmware/recording/image_memory.h"

#include <cstring>

#include "common/image_planes.h"

namespace bevloc::firmware {
namespace {

/// Copies rows and returns the place behind the last one.
uint8_t* copy_rows(const ImagePlane& plane, const PlaneSize& size, uint8_t* target) {
  for (int row = 0; row < size.rows; ++row, target += size.row_bytes) {
    std::memcpy(target, plane.data + row * plane.stride_bytes, size.row_bytes);
  }
  return target;
}

}  // namespace

std::optional<RecordedImage> ImageMemory::copy(const drivers::Frame& frame, Time now) {
  const ImageView& source = frame.image();
  const PlaneSize first = plane_size(source, 0);
  const PlaneSize chroma = plane_size(source, 1);
  const size_t needed = first.bytes() + chroma.bytes();
  if (needed > bytes_) return std::nullopt;
  RecordedImage copy{frame.camera,    now,   frame.time, frame.exposure, frame.sequence,
                     pool_->borrow(), source};
  if (!copy.memory) return std::nullopt;
  uint8_t* const memory = pool_->image(copy.memory).pixels.data();
  uint8_t* const behind = copy_rows(source.planes[0], first, memory);
  copy_rows(source.planes[1], chroma, behind);
  copy.image.bytes_used = needed;
  copy.image.planes[0] = {memory, static_cast<std::ptrdiff_t>(first.row_bytes)};
  if (chroma.rows > 0) {
    copy.image.planes[1] = {behind, static_cast<std::ptrdiff_t>(chroma.row_bytes)};
  }
  return copy;
}

}  // namespace bevloc::firmware
