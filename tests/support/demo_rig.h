// The rig of the demo.
#pragma once

#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::test {

inline Rig demo_rig() {
  return read_rig(BEVLOC_SOURCE_DIR "/config/rig_demo.yaml").value();
}

/// The rig of the demo with smaller pictures, which the simulator draws faster. Width and height
/// are divided by `divisor`.
inline Rig small_demo_rig(int divisor) {
  Rig rig = demo_rig();
  for (CameraModel& camera : rig.cameras) {
    const Intrinsics& lens = camera.intrinsics;
    camera.intrinsics = resized(lens, lens.width_px / divisor, lens.height_px / divisor);
  }
  return rig;
}

}  // namespace bevloc::test
