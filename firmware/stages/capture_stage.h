// The capture stage: takes the frames of one camera and restarts the camera when it fails.
#pragma once

#include <atomic>
#include <string_view>

#include "common/result.h"
#include "drivers/camera/camera.h"
#include "drivers/camera/stamp_steps.h"
#include "drivers/clock/clock.h"
#include "firmware/stages/messages.h"
#include "firmware/telemetry/cause_log.h"
#include "firmware/threads/heartbeat.h"

namespace bevloc::firmware {

/// Stops a camera that fails and starts it again after a pause, without limit, because a loose
/// connector must not end localization. If a camera cannot start or fails while it runs, the
/// driver's own message is logged, once per cause. A camera that delivers no frame for two seconds
/// is logged, too. A camera that stays silent is started again, because some drivers need that
/// after a stall.
/// Thread-bound: called from the camera's own thread. The counters are readable from any thread.
class CaptureStage {
 public:
  /// All arguments must outlive the stage.
  CaptureStage(drivers::Camera& camera, const drivers::Clock& clock, FrameQueue& frames);

  /// Waits for a frame, at most `timeout`, and queues it. Returns false when no frame will come any
  /// more.
  bool step(Duration timeout);
  /// Stops the camera. The next step() starts it again.
  void stop();

  /// Beats at each step. While the camera starts or stops, its deadline is longer.
  Heartbeat& heartbeat() { return heartbeat_; }
  const Heartbeat& heartbeat() const { return heartbeat_; }

  drivers::CameraCounters driver_counters() const { return camera_.counters(); }
  uint64_t captured() const { return captured_; }
  uint64_t failures() const { return failures_; }

 private:
  static constexpr Duration kPauseAfterFailure = std::chrono::milliseconds(500);
  /// A camera without frames for this long is logged as silent. So a camera that is slower than
  /// half a frame per second is logged although it is not faulty.
  static constexpr Duration kSilence = std::chrono::seconds(2);
  /// A silent camera is started again after the least time, then after twice that time, and so on
  /// up to the most. The time grows because a camera without a trigger is silent although it is not
  /// faulty.
  static constexpr Duration kLeastPatience = std::chrono::seconds(10);
  static constexpr Duration kMostPatience = std::chrono::seconds(160);
  /// The deadline while a device is opened or closed, which takes up to some seconds.
  static constexpr Duration kDeviceDeadline = std::chrono::seconds(10);

  bool ensure_started(Time now);
  void note_failure(Time now);
  void note_silence(Time now);
  void note_frame(Time now, drivers::Frame& frame);
  /// Logs `what` the camera does not do and why, once per cause.
  void log_cause(std::string_view what, std::string_view reason, Time now);

  drivers::Camera& camera_;
  const drivers::Clock& clock_;
  FrameQueue& frames_;
  Heartbeat heartbeat_;
  bool running_ = false;
  Time next_start_ = Time::min();
  CauseLog causes_;
  drivers::StampSteps stamp_steps_;
  Time waiting_since_{};  ///< the latest frame, start or log line about the silence
  Time silent_since_{};   ///< time of the latest frame or start
  Duration patience_ = kLeastPatience;
  bool failing_ = false;  ///< a cause was logged and no frame has come since
  std::atomic<uint64_t> captured_{0};
  std::atomic<uint64_t> failures_{0};
};

}  // namespace bevloc::firmware
