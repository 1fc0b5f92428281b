// A camera behind libcamera.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/device_camera.h"
#include "drivers/camera/device_frame_counter.h"
#include "drivers/clock/clock.h"

namespace bevloc::drivers {

namespace libcam {
class CaptureSession;
}

/// Ids of libcamera's cameras, as `cam -l` shows them.
std::vector<std::string> libcamera_ids();

/// Pictures are lent out as they lie in libcamera's dmabufs, mapped once; giving one back queues
/// its request again. Each start() looks the camera up anew by `id`, as `cam -l` shows it. Controls
/// have libcamera's names (AeEnable, ExposureTime in microseconds, AnalogueGain). The rate is set
/// where the camera has FrameDurationLimits; USB cameras have not, and run as they do.
class LibcameraCamera final : public Camera {
 public:
  /// The clock must be the machine's: libcamera stamps by it.
  LibcameraCamera(DeviceCameraConfig config, Clock& clock);
  ~LibcameraCamera() override;

  Status start() override;
  void stop() override;
  Result<FrameEvent> next_frame(Duration timeout, Frame& frame) override;
  /// `buffers` is what the camera gave, once it has been started.
  CameraDescription description() const override;
  CameraCounters counters() const override { return counter_.counters(); }

 private:
  /// Whether the request's picture is whole and timed; then it is in `frame`.
  bool take(int slot, Frame& frame);

  const DeviceCameraConfig config_;
  Clock& clock_;
  std::shared_ptr<libcam::CaptureSession> session_;
  DeviceFrameCounter counter_;
  std::atomic<int> buffers_;
};

}  // namespace bevloc::drivers
