// The frames of six cameras at one time: what the localizer works on.
#pragma once

#include <array>

#include "common/time.h"
#include "drivers/camera/frame.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::drivers {

struct Frameset {
  Time time;           ///< of its earliest frame
  CameraMask present;  ///< only these of `frames` are filled in
  std::array<Frame, kCameraCount> frames;
  Duration spread{0};  ///< from its earliest to its latest frame
};

}  // namespace bevloc::drivers
