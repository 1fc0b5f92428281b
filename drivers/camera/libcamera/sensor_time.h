// Converts libcamera's SensorTimestamp to the steady clock.
#pragma once

#include <cstdint>

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

}  // namespace bevloc::drivers::libcam
