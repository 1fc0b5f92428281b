#include "firmware/capture_stage.h"

#include <thread>

namespace bevloc::firmware {

CaptureStage::CaptureStage(drivers::Camera& camera, const drivers::Clock& clock, FrameQueue& frames)
    : camera_(camera), clock_(clock), frames_(frames) {}

bool CaptureStage::step(Duration timeout) {
  if (!started(clock_.now())) {
    std::this_thread::sleep_for(timeout);
    return true;
  }
  drivers::Frame frame;
  const auto event = camera_.next_frame(timeout, frame);
  if (!event) {
    note_failure(clock_.now());
    return true;
  }
  if (*event == drivers::FrameEvent::kFrame) {
    ++captured_;
    frames_.push(std::move(frame));
  }
  return *event != drivers::FrameEvent::kEnded;
}

void CaptureStage::stop() {
  camera_.stop();
  running_ = false;
}

bool CaptureStage::started(Time now) {
  if (running_) return true;
  if (now < next_start_) return false;
  if (!camera_.start()) {
    note_failure(now);
    return false;
  }
  running_ = true;
  return true;
}

void CaptureStage::note_failure(Time now) {
  ++failures_;
  camera_.stop();
  running_ = false;
  next_start_ = now + kPauseAfterFailure;
}

}  // namespace bevloc::firmware
