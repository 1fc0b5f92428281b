// The camera rig of the simulated vehicle.
#pragma once

#include "pipeline/calibration/rig.h"

namespace bevloc::sim {

/// Six cameras of 640 x 360 pixels, mounted as on the nuScenes vehicle (scene-0061): 1.5 m high,
/// about 65 degrees wide (the back camera about 90), with mild lens distortion.
Rig nominal_rig();

}  // namespace bevloc::sim
