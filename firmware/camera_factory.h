// Makes the six cameras that the configuration names.
#pragma once

#include <memory>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/config.h"

namespace bevloc::firmware {

/// In the order of kCameraNames; for drivers other than mock. A device that is missing is no error:
/// its capture stage looks for it again and again. Replays are all shifted by the same time so that
/// the recording begins now; they fail when their index cannot be read.
Result<std::vector<std::unique_ptr<drivers::Camera>>> make_cameras(const CameraConfig& config,
                                                                   const Rig& rig,
                                                                   drivers::Clock& clock);

/// Looks for every camera and says which one is missing, and what is there instead.
Status check_cameras(const CameraConfig& config);

}  // namespace bevloc::firmware
