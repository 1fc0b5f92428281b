// A frameset: the frames of up to six cameras that belong to one moment.
#pragma once

#include <array>

#include "common/cameras.h"
#include "common/time.h"
#include "drivers/camera/frame.h"

namespace bevloc::drivers {

struct Frameset {
  Time time;           ///< time of its earliest frame
  CameraMask present;  ///< the cameras whose frames are in the set
  /// One frame for each camera. It is empty if the camera is not in `present`.
  std::array<Frame, kCameraCount> frames;
  Duration spread{0};  ///< time from its earliest to its latest frame
};

}  // namespace bevloc::drivers
