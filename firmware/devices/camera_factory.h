// Makes the six cameras of the configuration.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/config/config.h"

namespace bevloc::firmware {

/// Makes the cameras in the order of kCameraNames. A missing device is no error here, because its
/// capture stage tries again without limit. All replays are shifted by the same time, so that the
/// recording begins one second from now. Fails when the index of a recording cannot be read, when
/// this build lacks the driver, and for mock cameras. `clock` must outlive the cameras.
Result<std::vector<std::unique_ptr<drivers::Camera>>> make_cameras(const CameraConfig& config,
                                                                   const Rig& rig,
                                                                   drivers::Clock& clock);

/// Looks up every camera, then starts all of them together and stops them again. So each camera
/// sets its format, rate and controls, and allocates its buffers. The error names the first camera
/// that is missing (and lists the devices that exist) or that cannot do what is configured. Logs
/// readout_warning(). If recordings are configured, reads their indices instead.
Status check_cameras(const CameraConfig& config, const Rig& rig);

/// Returns a warning that names the cameras whose `readout_ms` is not used. It is empty if there is
/// none. Call it while the cameras run.
std::string readout_warning(std::span<const drivers::CameraDescription> cameras);

}  // namespace bevloc::firmware
