// Copies the frames of one camera into memory of the recorder, so that the camera keeps its own.
#pragma once

#include <memory>
#include <optional>

#include "drivers/camera/frame_pool.h"
#include "firmware/recording/recorded_events.h"

namespace bevloc::firmware {

/// Allocates in its constructor only. Thread-bound: copy() is called from the camera's own thread.
/// Any thread may drop the copies.
class ImageMemory {
 public:
  ImageMemory(int images, int width_px, int height_px)
      : pool_(drivers::FramePool::create(images, width_px, height_px)),
        bytes_(3 * static_cast<size_t>(width_px) * static_cast<size_t>(height_px)) {}

  /// Copies a frame. Returns nothing when all memory is in use or the image needs more than three
  /// bytes per pixel.
  std::optional<RecordedImage> copy(const drivers::Frame& frame, Time now);

 private:
  std::shared_ptr<drivers::FramePool> pool_;
  size_t bytes_;
};

}  // namespace bevloc::firmware
