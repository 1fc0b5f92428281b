// One picture of one camera, and when it was taken.
#pragma once

#include <cstdint>

#include "common/time.h"
#include "drivers/camera/frame_buffer.h"

namespace bevloc::drivers {

struct Frame {
  int camera = 0;  ///< index into kCameraNames
  /// Start of exposure of the first row.
  Time time;
  /// The sensor's own count since start(); a gap says how many frames were lost on the way.
  uint64_t sequence = 0;
  Duration exposure{0};
  FrameBuffer buffer;

  /// As the camera delivered it.
  const ImageView& image() const { return buffer.view(); }
  /// Of an RGB frame: mock and replay cameras make no others.
  RgbView pixels() const { return image().rgb(); }
};

}  // namespace bevloc::drivers
