// From libcamera's SensorTimestamp to the steady clock.
#pragma once

#include <cstdint>

#include "common/time.h"

namespace bevloc::drivers::libcam {

/// libcamera documents CLOCK_BOOTTIME, but pipelines that pass on what V4L2 stamped (USB cameras)
/// deliver CLOCK_MONOTONIC. The two differ by the time that the machine has slept, and a frame is
/// never younger than now: what would be is boot time.
constexpr Time steady_time(int64_t sensor_timestamp_ns, Time now, Duration slept) {
  const Time stamp{Duration(sensor_timestamp_ns)};
  return stamp > now ? stamp - slept : stamp;
}

}  // namespace bevloc::drivers::libcam
