// A camera of libcamera.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/device_camera.h"
#include "drivers/camera/device_frame_counter.h"
#include "drivers/clock/clock.h"

namespace libcamera {
class CameraManager;
}

namespace bevloc::drivers {

namespace libcam {
class CaptureSession;
}

/// Returns the ids of libcamera's cameras, as `cam -l` shows them.
std::vector<std::string> libcamera_ids();

/// Frames refer to libcamera's dmabufs, which are mapped once. Dropping a frame queues its request
/// again. Each start() looks for the camera by its `id`, as `cam -l` shows it. Controls have
/// libcamera's names (AeEnable, ExposureTime in microseconds, AnalogueGain). The rate is set if the
/// camera has the control FrameDurationLimits. USB cameras do not have it and keep their own rate.
/// If `readout` is given, exposure and readout are subtracted from each time stamp. From the first
/// start() on, libcamera runs until all cameras are destroyed. It notices by udev which cameras are
/// plugged in.
class LibcameraCamera final : public Camera {
 public:
  /// `clock` must be a MonotonicClock, because libcamera's time stamps are compared with it.
  LibcameraCamera(DeviceCameraConfig config, Clock& clock);
  ~LibcameraCamera() override;

  Status start() override;
  void stop() override;
  Result<FrameEvent> next_frame(Duration timeout, Frame& frame) override;
  /// After start(), `buffers` is the number that the camera allocated.
  CameraDescription description() const override;
  CameraCounters counters() const override { return counter_.counters(); }

 private:
  /// Fills `frame`. Returns false for an image that is incomplete or has no time stamp.
  bool take(int slot, Frame& frame);

  const DeviceCameraConfig config_;
  Clock& clock_;
  std::shared_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcam::CaptureSession> session_;
  DeviceFrameCounter counter_;
  std::atomic<int> buffers_;
};

}  // namespace bevloc::drivers
