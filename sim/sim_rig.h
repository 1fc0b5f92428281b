// The rig of the simulated vehicle.
#pragma once

#include "pipeline/calibration/rig.h"

namespace bevloc::sim {

/// Six 640x360 cameras placed as on a nuScenes car (scene-0061): five of about 65 degrees, the back
/// one of about 90, 1.5 m high, with mild lens distortion.
Rig nominal_rig();

}  // namespace bevloc::sim
