// What a recording gives to a replay.
#pragma once

#include "evaluation/recording/recording.h"
#include "evaluation/recording/replay.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// The recorded frames, positions of gpsd and images. Refuses a rig whose images have another size
/// than the recorded ones.
Result<ReplayInputs> inputs_of(Recording& recording, const Rig& rig);

}  // namespace bevloc::evaluation
