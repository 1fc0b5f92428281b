// A camera of the kernel's Video4Linux2 interface.
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
  DeviceCameraConfig device;  ///< `id` is a name for find_video_node()
  v4l2::MemoryAccess memory = v4l2::MemoryAccess::kMapped;
};

/// Frames refer to the driver's memory, without a copy. Dropping a frame queues its buffer again.
/// Each start() looks for the device, so a camera is also found at another port. Damaged frames
/// (marked by the driver, or incomplete) are counted and dropped. `overrun` stays 0, because the
/// kernel keeps frames that are not fetched until it has no free buffer. Then the sequence has a
/// gap.
class V4l2Camera final : public Camera {
 public:
  /// `clock` must be a MonotonicClock, because the kernel stamps frames with this clock.
  V4l2Camera(V4l2CameraConfig config, Clock& clock);
  ~V4l2Camera() override { stop(); }
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  Status start() override;
  void stop() override;
  Result<FrameEvent> next_frame(Duration timeout, Frame& frame) override;
  /// After start(), `buffers` is the value of the device.
  CameraDescription description() const override;
  CameraCounters counters() const override { return counter_.counters(); }

 private:
  enum class Wait : uint8_t { kReady, kTimeout };

  Result<std::shared_ptr<v4l2::Stream>> open_stream() const;
  Wait wait_until(Time time) const;
  /// Fetches a frame. Returns kTimeout when there was none or it was damaged.
  Result<FrameEvent> take(Frame& frame);

  const V4l2CameraConfig config_;
  Clock& clock_;
  std::shared_ptr<v4l2::Stream> stream_;
  v4l2::StampRule stamp_rule_;
  DeviceFrameCounter counter_;
  std::atomic<int> buffers_;
  std::atomic<bool> ignores_readout_{false};
};

}  // namespace bevloc::drivers
