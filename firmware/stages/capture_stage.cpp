#include "firmware/stages/capture_stage.h"

#include <algorithm>
#include <string>
#include <thread>
#include <utility>

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
  const Time now = clock_.now();
  if (!event) {
    log_cause("fails", event.error().message, now);
    note_failure(now);
    return true;
  }
  if (*event == drivers::FrameEvent::kFrame) {
    note_frame(now, frame);
    frames_.push(std::move(frame));
  } else if (*event == drivers::FrameEvent::kTimeout) {
    note_silence(now);
  }
  return *event != drivers::FrameEvent::kEnded;
}

void CaptureStage::note_silence(Time now) {
  if (now - waiting_since_ <= kSilence) return;
  log_cause("is silent", "no frame for 2 s; check cable, power and trigger", now);
  waiting_since_ = now;
  if (now - silent_since_ < patience_) return;
  note_failure(now);
  patience_ = std::min(2 * patience_, kMostPatience);
}

void CaptureStage::note_frame(Time now, drivers::Frame& frame) {
  ++captured_;
  waiting_since_ = silent_since_ = now;
  patience_ = kLeastPatience;
  frame.stamp_jumped = stamp_steps_.add(frame.time, now, frame.sequence);
  frame.stamp_jumps = stamp_steps_.jumps();
  constexpr std::string_view kJumped = "its time stamps jumped, but its frames arrive as before";
  if (frame.stamp_jumped && causes_.is_new(kJumped, now)) {
    spdlog::warn("camera {}: {}; check its clock and its driver, then restart bevlocd",
                 kCameraNames[camera_.description().camera], kJumped);
  }
  if (!std::exchange(failing_, false)) return;
  spdlog::info("camera {}: delivers frames again", kCameraNames[camera_.description().camera]);
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
    log_cause("cannot start", started.error().message, now);
    note_failure(now);
    return false;
  }
  heartbeat_.beat();
  running_ = true;
  stamp_steps_.reset();
  // A start may take some seconds.
  waiting_since_ = silent_since_ = clock_.now();
  return true;
}

void CaptureStage::note_failure(Time now) {
  ++failures_;
  stop();
  next_start_ = now + kPauseAfterFailure;
}

void CaptureStage::log_cause(std::string_view what, std::string_view reason, Time now) {
  if (!causes_.is_new(reason, now)) return;
  failing_ = true;
  const std::string place = fmt::format("camera {}: ", kCameraNames[camera_.description().camera]);
  if (reason.starts_with(place)) reason.remove_prefix(place.size());
  spdlog::warn("{}{}: {}; trying again until it works", place, what, reason);
}

}  // namespace bevloc::firmware
