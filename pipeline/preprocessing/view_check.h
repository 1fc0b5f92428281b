// Checks whether the cameras of a rig show what the network looks at.
#pragma once

#include <string>

#include "common/result.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

/// The share of the network image below the horizon, 0 to 1, that shows the surroundings. The rest
/// is black for the network, because it lies outside of the camera's image or on the own vehicle.
/// The camera must be one of a rig without a mistake (find_mistake()).
double shown_share(const CameraModel& camera);

/// Fails if a camera shows less than a quarter of its network image below the horizon, such as one
/// that looks at the sky, or only at the ground beside the vehicle. Returns a warning if a camera
/// shows less than 90 %, otherwise "". Either text begins with `file`, the name of the rig file.
Result<std::string> check_views(const Rig& rig, const std::string& file);

}  // namespace bevloc
