// A real lens whose distortion folds outside of its image.
#pragma once

#include "pipeline/calibration/camera_model.h"

namespace bevloc::test {

/// Right camera of the data set MVSEC. Its distorted angle falls again beyond 72 degrees, 231
/// pixels from the principal point; the farthest corner is at 221 pixels.
inline Intrinsics folding_fisheye() {
  return {.lens = Lens::kFisheye,
          .width_px = 346,
          .height_px = 260,
          .fx_px = 226.018,
          .fy_px = 225.787,
          .cx_px = 174.543,
          .cy_px = 124.216,
          .k1 = -0.04847,
          .k2 = 0.01009,
          .k3 = -0.04293,
          .k4 = 0.00519};
}

}  // namespace bevloc::test
