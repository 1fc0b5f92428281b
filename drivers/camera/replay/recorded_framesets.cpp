#include "drivers/camera/replay/recorded_framesets.h"

#include <algorithm>

namespace bevloc::drivers {

FrameTimes times_of(const RecordedFrames& frames) {
  FrameTimes times;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    for (const RecordedFrame& frame : frames[camera]) times[camera].push_back(frame.time);
  }
  return times;
}

std::vector<FramesetPlace> framesets_of(const FrameTimes& times) {
  struct CameraFrame {
    Time time;
    int camera = 0;
    size_t number = 0;
  };
  std::vector<CameraFrame> frames;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    for (size_t i = 0; i < times[camera].size(); ++i)
      frames.push_back({times[camera][i], camera, i});
  }
  std::ranges::stable_sort(frames, {}, &CameraFrame::time);
  std::vector<FramesetPlace> framesets;
  for (const CameraFrame& frame : frames) {
    const bool begins = framesets.empty() || frame.time - framesets.back().time > kWidestSpread ||
                        framesets.back().present[frame.camera];
    if (begins) framesets.push_back({.time = frame.time});
    framesets.back().present.set(frame.camera);
    framesets.back().frame[frame.camera] = frame.number;
  }
  return framesets;
}

}  // namespace bevloc::drivers
