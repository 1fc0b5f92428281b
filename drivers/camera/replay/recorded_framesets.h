// Groups the frames of a recording or a picture folder into framesets.
#pragma once

#include <array>
#include <vector>

#include "common/cameras.h"
#include "common/time.h"
#include "drivers/camera/replay/replay_camera.h"

namespace bevloc::drivers {

/// Frames of several cameras within this time are one frameset.
inline constexpr Duration kWidestSpread = std::chrono::milliseconds(50);

/// Where the frames of a frameset are among all frames of their cameras.
struct FramesetPlace {
  Time time;                                 ///< when its earliest exposure started
  CameraMask present{};                      ///< the cameras that have a frame: at least one
  std::array<size_t, kCameraCount> frame{};  ///< its number among the camera's frames
};

/// The times of each camera's frames, in order.
using FrameTimes = std::array<std::vector<Time>, kCameraCount>;

FrameTimes times_of(const RecordedFrames& frames);

/// Groups the frames of all cameras into framesets, in the order of time. A frameset begins at the
/// first frame that is too late for the one before, or whose camera that one has already.
std::vector<FramesetPlace> framesets_of(const FrameTimes& times);

}  // namespace bevloc::drivers
