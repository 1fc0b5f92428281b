#include "firmware/stages/capture_stage.h"

#include <string_view>
#include <thread>

#include <spdlog/spdlog.h>

#include "common/cameras.h"

namespace bevloc::firmware {

CaptureStage::CaptureStage(drivers::Camera& camera, const drivers::Clock& clock, FrameQueue& frames)
    : camera_(camera), clock_(clock), frames_(frames) {}

bool CaptureStage::step(Duration timeout) {
  heartbeat_.beat();
  if (!ensure_started(clock_.now())) {
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
    logged_reason_.clear();
    frames_.push(std::move(frame));
  }
  return *event != drivers::FrameEvent::kEnded;
}

void CaptureStage::stop() {
  heartbeat_.beat(kDeviceDeadline);
  camera_.stop();
  running_ = false;
}

bool CaptureStage::ensure_started(Time now) {
  if (running_) return true;
  if (now < next_start_) return false;
  heartbeat_.beat(kDeviceDeadline);
  if (const Status started = camera_.start(); !started) {
    log_failed_start(started.error());
    note_failure(now);
    return false;
  }
  heartbeat_.beat();
  running_ = true;
  return true;
}

void CaptureStage::note_failure(Time now) {
  ++failures_;
  stop();
  next_start_ = now + kPauseAfterFailure;
}

void CaptureStage::log_failed_start(const Error& error) {
  if (error.message == logged_reason_) return;
  logged_reason_ = error.message;
  const std::string place = fmt::format("camera {}: ", kCameraNames[camera_.description().camera]);
  std::string_view reason = error.message;
  if (reason.starts_with(place)) reason.remove_prefix(place.size());
  spdlog::warn("{}cannot start: {}; trying again every {} s", place, reason,
               to_seconds(kPauseAfterFailure));
}

}  // namespace bevloc::firmware
