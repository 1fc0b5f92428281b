#include "drivers/camera/v4l2/timestamps.h"

#include <linux/videodev2.h>

namespace bevloc::drivers::v4l2 {

Result<StampRule> stamp_rule(uint32_t buffer_flags, Duration exposure,
                             std::optional<Duration> readout) {
  if ((buffer_flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    return fail("found frames with buffer flags {:#x}, wanted timestamps of the monotonic clock",
                buffer_flags);
  }
  if ((buffer_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE) {
    return StampRule{.exposure_to_stamp = Duration::zero(), .ignores_readout = readout.has_value()};
  }
  if (!readout) {
    return fail(
        "frames are stamped at their end; set readout_ms, the time from the end of exposure of the "
        "first row to that of the last row");
  }
  return StampRule{.exposure_to_stamp = exposure + *readout, .ignores_readout = false};
}

Time exposure_start(const timeval& stamp, const StampRule& rule) {
  return Time(std::chrono::seconds(stamp.tv_sec) + std::chrono::microseconds(stamp.tv_usec)) -
         rule.exposure_to_stamp;
}

}  // namespace bevloc::drivers::v4l2
