// A frame: one image from one camera, with its time, sequence number and buffer.
#pragma once

#include <cstdint>

#include "common/time.h"
#include "drivers/camera/frame_buffer.h"

namespace bevloc::drivers {

struct Frame {
  int camera = 0;  ///< index into kCameraNames
  /// Start of exposure of the first row.
  Time time;
  /// Counts the sensor's frames since start(). A gap shows how many frames were lost.
  uint64_t sequence = 0;
  Duration exposure{0};
  FrameBuffer buffer;
  /// Whether the time stamps of this camera have jumped (StampSteps), so that `time` is wrong.
  /// CaptureStage sets it.
  bool stamp_jumped = false;
  /// How often they have jumped (StampSteps::jumps()). CaptureStage sets it, too.
  uint64_t stamp_jumps = 0;

  /// The image in the format that the camera delivered.
  const ImageView& image() const { return buffer.view(); }
  /// Requires format kRgb24, which mock and replay cameras always deliver.
  RgbView pixels() const { return image().rgb(); }
};

}  // namespace bevloc::drivers
