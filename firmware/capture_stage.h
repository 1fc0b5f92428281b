// One camera's frames into the pipeline's queue.
#pragma once

#include <atomic>

#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/messages.h"

namespace bevloc::firmware {

/// Thread: one per camera; counters from any. A camera that fails is stopped and started again
/// after a pause, for ever: a loose connector must not end localization.
class CaptureStage {
 public:
  CaptureStage(drivers::Camera& camera, const drivers::Clock& clock, FrameQueue& frames);

  /// Waits for a frame, `timeout` at most, and hands it on. False once none will ever come.
  bool step(Duration timeout);
  void stop();

  uint64_t captured() const { return captured_; }
  uint64_t failures() const { return failures_; }

 private:
  static constexpr Duration kPauseAfterFailure = std::chrono::milliseconds(500);

  bool started(Time now);
  void note_failure(Time now);

  drivers::Camera& camera_;
  const drivers::Clock& clock_;
  FrameQueue& frames_;
  bool running_ = false;
  Time next_start_ = Time::min();
  std::atomic<uint64_t> captured_{0};
  std::atomic<uint64_t> failures_{0};
};

}  // namespace bevloc::firmware
