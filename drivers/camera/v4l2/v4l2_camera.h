// A camera behind the kernel's Video4Linux2 interface.
#pragma once

#include <atomic>
#include <memory>

#include "drivers/camera/camera.h"
#include "drivers/camera/device_camera.h"
#include "drivers/camera/device_frame_counter.h"
#include "drivers/camera/v4l2/device_finder.h"
#include "drivers/camera/v4l2/stream.h"
#include "drivers/camera/v4l2/timestamps.h"
#include "drivers/clock/clock.h"

namespace bevloc::drivers {

struct V4l2CameraConfig {
  DeviceCameraConfig device;  ///< id as find_video_node() takes it
  v4l2::MemoryAccess memory = v4l2::MemoryAccess::kMapped;
};

/// Pictures are lent out as they lie in the driver's memory; giving one back queues it again. Each
/// start() looks the device up anew, so that a camera is found wherever it is plugged in next.
/// Damaged pictures (marked by the driver, or short) are counted and dropped. `overrun` stays 0:
/// the kernel keeps what is not fetched until it runs out of buffers, and then the sequence has a
/// gap.
class V4l2Camera final : public Camera {
 public:
  /// The clock must be the machine's: the kernel stamps by it.
  V4l2Camera(V4l2CameraConfig config, Clock& clock);

  Status start() override;
  void stop() override;
  Result<FrameEvent> next_frame(Duration timeout, Frame& frame) override;
  /// `buffers` and `timestamp_origin` are what the device gave, once it has been started.
  CameraDescription description() const override;
  CameraCounters counters() const override { return counter_.counters(); }

 private:
  enum class Wait : uint8_t { kReady, kTimeout };

  Result<std::shared_ptr<v4l2::Stream>> open_stream() const;
  Wait wait_until(Time time) const;
  /// kTimeout when there was no picture, or one that is no good.
  Result<FrameEvent> take(Frame& frame);

  const V4l2CameraConfig config_;
  Clock& clock_;
  std::shared_ptr<v4l2::Stream> stream_;
  v4l2::StampRule stamp_rule_;
  DeviceFrameCounter counter_;
  std::atomic<int> buffers_;
  std::atomic<TimestampOrigin> origin_{TimestampOrigin::kExposureStart};
};

}  // namespace bevloc::drivers
