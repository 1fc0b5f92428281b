// Reference poses from what bevloc itself sent, for drives without a reference system.
#pragma once

#include "common/result.h"
#include "evaluation/recording/recording.h"
#include "pipeline/calibration/reference_trajectory.h"

namespace bevloc::drives {

/// When a solution of the appliance is sure enough to be a reference.
struct SureLimits {
  double position_sigma_m = 0.5;  ///< along the worse axis
  double yaw_sigma_rad = radians(0.6);
  Duration settle = std::chrono::seconds(3);  ///< left out after each time that it was not sure
};

/// The recorded solutions where the state was TRACKING and their sigmas were within the limits. A
/// pose is smoothed with the solutions of half a second before and after it: the value at its time
/// of the parabola that fits them best. The result has no poses if the appliance was never sure.
Result<ReferenceTrajectory> own_track(evaluation::Recording& recording,
                                      const SureLimits& limits = {});

/// The smoothed middle of `poses`, which are in the order of time. Fewer than five poses are not
/// smoothed.
std::vector<ReferenceTrajectory::Pose> smoothed(
    const std::vector<ReferenceTrajectory::Pose>& poses);

}  // namespace bevloc::drives
