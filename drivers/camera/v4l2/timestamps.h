// Converts the time stamp of a V4L2 buffer to the start of exposure.
#pragma once

#include <cstdint>
#include <optional>

#include <sys/time.h>

#include "common/result.h"
#include "common/time.h"
#include "drivers/camera/camera.h"

namespace bevloc::drivers::v4l2 {

/// How to get from a stamp to the start of exposure.
struct StampRule {
  /// From the start of exposure until the device stamps a buffer. It is 0 for a device that says
  /// that it stamps the start of exposure.
  Duration exposure_to_stamp{0};
  bool ignores_readout = false;  ///< as in CameraDescription
};

/// Derives the rule from the flags of a buffer. Fails for a device that does not use
/// CLOCK_MONOTONIC (the steady clock), and for a device that stamps the end of frames if `readout`
/// is not given.
///
/// uvcvideo says that it stamps the start of exposure. But it stamps the first packet of an image,
/// which is later by the exposure time and the camera's own delay, unless the module has the
/// parameter hwtimestamps=1.
Result<StampRule> stamp_rule(uint32_t buffer_flags, Duration exposure,
                             std::optional<Duration> readout);

Time exposure_start(const timeval& stamp, const StampRule& rule);

}  // namespace bevloc::drivers::v4l2
