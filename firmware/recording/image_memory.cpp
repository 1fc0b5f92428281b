#include "firmware/recording/image_memory.h"

#include <algorithm>
#include <cstring>

#include "common/cameras.h"
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

int ImageMemory::images_for(int width_px, int height_px) {
  const size_t share = kMost_bytes / kCameraCount;
  const size_t images = share / std::max<size_t>(1, bytes_of(width_px, height_px));
  return static_cast<int>(std::clamp<size_t>(images, kLeastImages, kMostImages));
}

bool ImageMemory::fits(const ImageView& image) const {
  return plane_size(image, 0).bytes() + plane_size(image, 1).bytes() <= bytes_;
}

std::optional<RecordedImage> ImageMemory::copy(const drivers::Frame& frame, Time now) {
  const ImageView& source = frame.image();
  if (!fits(source)) return std::nullopt;
  const PlaneSize first = plane_size(source, 0);
  const PlaneSize chroma = plane_size(source, 1);
  RecordedImage copy{frame.camera,    now,   frame.time, frame.exposure, frame.sequence,
                     pool_->borrow(), source};
  if (!copy.memory) return std::nullopt;
  uint8_t* const memory = pool_->image(copy.memory).pixels.data();
  uint8_t* const behind = copy_rows(source.planes[0], first, memory);
  copy_rows(source.planes[1], chroma, behind);
  copy.image.bytes_used = first.bytes() + chroma.bytes();
  copy.image.planes[0] = {memory, static_cast<std::ptrdiff_t>(first.row_bytes)};
  if (chroma.rows > 0) {
    copy.image.planes[1] = {behind, static_cast<std::ptrdiff_t>(chroma.row_bytes)};
  }
  return copy;
}

}  // namespace bevloc::firmware
