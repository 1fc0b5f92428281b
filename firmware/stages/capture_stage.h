// The capture stage: takes the frames of one camera and restarts the camera when it fails.
#pragma once

#include <atomic>
#include <string>

#include "common/result.h"
#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/runtime/heartbeat.h"
#include "firmware/stages/messages.h"

namespace bevloc::firmware {

/// Stops a camera that fails and starts it again after a pause, without limit: a loose connector
/// must not end localization. Logs a warning with the reason when the camera cannot start, but not
/// again for the same reason before a frame has arrived. Thread-bound: called from the camera's
/// thread; counters are readable from any thread.
class CaptureStage {
 public:
  /// Everything passed in must outlive the stage.
  CaptureStage(drivers::Camera& camera, const drivers::Clock& clock, FrameQueue& frames);

  /// Waits for a frame, at most `timeout`, and queues it. False once no frame will ever come.
  bool step(Duration timeout);
  /// Stops the camera; the next step() starts it again.
  void stop();

  /// Beats at each step. While the camera starts or stops, its deadline is longer.
  Heartbeat& heartbeat() { return heartbeat_; }
  const Heartbeat& heartbeat() const { return heartbeat_; }

  uint64_t captured() const { return captured_; }
  uint64_t failures() const { return failures_; }

 private:
  static constexpr Duration kPauseAfterFailure = std::chrono::milliseconds(500);
  /// To open or to close a device takes up to some seconds, while a kernel driver waits for it.
  static constexpr Duration kDeviceDeadline = std::chrono::seconds(10);

  bool ensure_started(Time now);
  void note_failure(Time now);
  void log_failed_start(const Error& error);

  drivers::Camera& camera_;
  const drivers::Clock& clock_;
  FrameQueue& frames_;
  Heartbeat heartbeat_;
  bool running_ = false;
  Time next_start_ = Time::min();
  std::string logged_reason_;  ///< of the last failed start; empty after a frame
  std::atomic<uint64_t> captured_{0};
  std::atomic<uint64_t> failures_{0};
};

}  // namespace bevloc::firmware
