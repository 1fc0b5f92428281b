#include "firmware/stages/frameset_source.h"

#include <algorithm>
#include <utility>

#include "firmware/threads/clock_gap.h"

namespace bevloc::firmware {

FramesetSource::FramesetSource(const drivers::SynchronizerConfig& config, bool compensates,
                               const drivers::PulseLog* pulses, FrameQueue& frames)
    : synchronizer_(config), synchrony_(synchronizer_, compensates, pulses), frames_(frames) {}

void FramesetSource::take_frames(const drivers::Clock& clock, Duration timeout) {
  look_at_clock(clock);
  // A frameset that waits for a dead camera must be emitted on time although no frame arrives.
  if (const auto deadline = synchronizer_.deadline()) {
    timeout = std::clamp(*deadline - clock.now(), Duration::zero(), timeout);
  }
  for (auto frame = frames_.pop(timeout); frame; frame = frames_.pop(Duration::zero())) {
    look_at_clock(clock);
    add(std::move(*frame), clock.now());
  }
}

void FramesetSource::add(drivers::Frame frame, Time now) {
  const int camera = frame.camera;
  const bool jumped = frame.stamp_jumped;
  const uint64_t jumps = frame.stamp_jumps;
  const drivers::FrameFate fate = synchronizer_.add(std::move(frame), now);
  const bool fits = fate != drivers::FrameFate::kFuture && fate != drivers::FrameFate::kOutOfOrder;
  displaced_.cameras[camera] = jumped && !fits;
  if (displaced_.cameras[camera]) {
    displaced_.stamp_jumps = std::max(displaced_.stamp_jumps, jumps);
  }
}

void FramesetSource::look_at_clock(const drivers::Clock& clock) {
  const Time now = clock.now();
  const Duration suspended = clock.suspended();
  if (latest_look_) {
    // While the machine is suspended, the clock stands still.
    const bool was_suspended = suspended - suspended_ > ClockGapDetector::kSuspension;
    if (was_suspended || now - *latest_look_ > kGap) {
      ++counters_.clock_gaps;
      synchronizer_.forget_until(was_suspended ? now : *latest_look_);
    }
  }
  latest_look_ = now;
  suspended_ = suspended;
}

std::optional<NewestFrameset> FramesetSource::newest(Time now) {
  auto newest = poll(now);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    frames_of_[camera].store(synchronizer_.counters(camera));
  }
  return newest;
}

std::optional<NewestFrameset> FramesetSource::poll(Time now) {
  auto frameset = synchronizer_.poll(now);
  if (!frameset) return std::nullopt;
  NewestFrameset newest;
  while (auto newer = synchronizer_.poll(now)) {
    newest.skipped = true;
    ++counters_.skipped;
    counters_.frames_skipped += frameset->present.count();
    frameset = std::move(newer);
  }
  newest.unsynchronized = synchrony_.unsynchronized(*frameset, now);
  newest.frameset = std::move(*frameset);
  return newest;
}

}  // namespace bevloc::firmware
