// Converts libcamera's SensorTimestamp to the start of exposure, on the steady clock.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::drivers::libcam {

/// libcamera's documentation says CLOCK_BOOTTIME, but pipelines that pass on V4L2's time stamps
/// (USB cameras) deliver CLOCK_MONOTONIC. The clocks differ by the time that the machine was
/// suspended. A frame cannot be newer than `now`, so a later time stamp must be one of
/// CLOCK_BOOTTIME.
constexpr Time steady_time(int64_t sensor_timestamp_ns, Time now, Duration suspended) {
  const Time stamp{Duration(sensor_timestamp_ns)};
  return stamp > now ? stamp - suspended : stamp;
}

/// libcamera's documentation says that the stamp is the start of exposure. But its pipelines pass
/// on the kernel's stamp of the buffer, often that of the end of the frame, and do not say which.
/// So `readout` decides: with it, the stamp counts as later by exposure and readout; without it,
/// the stamp counts as the start of exposure.
constexpr Time exposure_start(Time stamp, Duration exposure, std::optional<Duration> readout) {
  return readout ? stamp - exposure - *readout : stamp;
}

}  // namespace bevloc::drivers::libcam
