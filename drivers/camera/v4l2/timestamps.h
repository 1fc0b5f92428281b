// From a V4L2 buffer's time stamp to the start of exposure.
#pragma once

#include <cstdint>
#include <optional>

#include <sys/time.h>

#include "common/result.h"
#include "common/time.h"
#include "drivers/camera/camera.h"

namespace bevloc::drivers::v4l2 {

/// How a device stamps its buffers, and how to get from there to the start of exposure.
struct StampRule {
  TimestampOrigin origin = TimestampOrigin::kExposureStart;
  Duration exposure_to_stamp{0};
};

/// From a buffer's flags. Fails for a device that does not stamp by CLOCK_MONOTONIC, which is the
/// steady clock, and for one that stamps the end of frames when the read-out time is not known.
Result<StampRule> stamp_rule(uint32_t buffer_flags, Duration exposure,
                             std::optional<Duration> readout);

Time exposure_start(const timeval& stamp, const StampRule& rule);

}  // namespace bevloc::drivers::v4l2
