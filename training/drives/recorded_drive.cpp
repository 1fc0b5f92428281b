#include "training/drives/recorded_drive.h"

#include <algorithm>

namespace bevloc::drives {

std::vector<FramesetPlace> framesets_of(const std::array<std::vector<Time>, kCameraCount>& times) {
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

}  // namespace bevloc::drives
