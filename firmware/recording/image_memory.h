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
  static constexpr int kMostImages = 6;
  /// One image is written while the camera delivers the next one.
  static constexpr int kLeastImages = 2;
  /// The memory of all cameras together, unless kLeastImages of each need more. With this memory,
  /// the images that the writer works on and a map of 3,000 km, the daemon stays below the 512 MiB
  /// that its unit allows (systemd/bevlocd.service).
  static constexpr size_t kMost_bytes = size_t{128} << 20U;

  ImageMemory(int width_px, int height_px)
      : pool_(drivers::FramePool::create(images_for(width_px, height_px), width_px, height_px)),
        bytes_(bytes_of(width_px, height_px)) {}

  /// The number of images of this size for which there is memory.
  static int images_for(int width_px, int height_px);

  /// Whether the image needs no more than three bytes for each pixel of the size that was given to
  /// the constructor.
  bool fits(const ImageView& image) const;

  /// Copies a frame. Returns nothing when all memory is in use or the image does not fit.
  std::optional<RecordedImage> copy(const drivers::Frame& frame, Time now);

 private:
  static size_t bytes_of(int width_px, int height_px) {
    return 3 * static_cast<size_t>(width_px) * static_cast<size_t>(height_px);
  }

  std::shared_ptr<drivers::FramePool> pool_;
  size_t bytes_;
};

}  // namespace bevloc::firmware
