// A rig whose cameras look further up or down.
#pragma once

#include "common/se2.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::test {

/// The rig with all cameras turned down by this angle.
inline Rig turned_down(Rig rig, double down_deg) {
  for (CameraModel& camera : rig.cameras) {
    camera.vehicle_from_camera.rotation *= rotation_by({-radians(down_deg), 0.0, 0.0});
  }
  return rig;
}

}  // namespace bevloc::test
