#include "drivers/frameset/synchronizer.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace bevloc::drivers {

void FramesetSynchronizer::CameraQueue::push(Frame frame) {
  if (frames.full()) {
    pop();
    ++counters.overflow;
  }
  frames.push_back(std::move(frame));
}

Frame FramesetSynchronizer::CameraQueue::pop() {
  Frame frame = std::move(frames.front());
  frames.pop_front();
  return frame;
}

FramesetSynchronizer::FramesetSynchronizer(const SynchronizerConfig& config) : config_(config) {
  assert(config.tolerance >= Duration::zero() && config.wait >= config.tolerance);
  assert(config.min_cameras >= 1 && config.min_cameras <= kCameraCount);
}

FrameFate FramesetSynchronizer::add(Frame frame, Time now) {
  assert(frame.camera >= 0 && frame.camera < kCameraCount);
  CameraQueue& camera = cameras_[frame.camera];
  SynchronizerCounters& counters = camera.counters;
  ++counters.added;
  const FrameFate fate = judge(camera, frame.time, now);
  if (fate == FrameFate::kAccepted || fate == FrameFate::kLate) {
    camera.newest = frame.time;
    camera.missed_in_a_row = 0;  // the camera is alive, so the next frameset waits for it
  }
  switch (fate) {
    case FrameFate::kAccepted:
      rates_.add(frame.camera, frame.time);
      camera.push(std::move(frame));
      break;
    case FrameFate::kDuplicate:
      ++counters.duplicate;
      break;
    case FrameFate::kOutOfOrder:
      ++counters.out_of_order;
      break;
    case FrameFate::kLate:
      ++counters.late;
      break;
    case FrameFate::kFuture:
      ++counters.future;
      break;
  }
  return fate;
}

FrameFate FramesetSynchronizer::judge(const CameraQueue& camera, Time time, Time now) const {
  if (time > now) return FrameFate::kFuture;
  if (time == camera.newest) return FrameFate::kDuplicate;
  if (time < camera.newest) return FrameFate::kOutOfOrder;
  if (time <= closed_until_) return FrameFate::kLate;
  return FrameFate::kAccepted;
}

std::optional<Frameset> FramesetSynchronizer::poll(Time now) {
  while (const std::optional<Time> opening = opening_time()) {
    const CameraMask waited_for = blockers();
    const bool waits = now < *opening + config_.wait && !any_queue_full();
    if (waited_for.any() && waits) return std::nullopt;
    const CameraMask found = members(*opening);
    closed_until_ = *opening + config_.tolerance;
    splits_.add(found);
    if (static_cast<int>(found.count()) >= config_.min_cameras) {
      return emit(*opening, found, waited_for);
    }
    discard(found);
  }
  return std::nullopt;
}

void FramesetSynchronizer::forget_until(Time time) {
  for (CameraQueue& camera : cameras_) {
    while (!camera.frames.empty() && camera.frames.front().time <= time) {
      camera.pop();
      ++camera.counters.unmatched;
    }
  }
  closed_until_ = std::max(closed_until_, time);
}

std::optional<Time> FramesetSynchronizer::deadline() const {
  const std::optional<Time> opening = opening_time();
  if (!opening) return std::nullopt;
  return *opening + config_.wait;
}

CameraMask FramesetSynchronizer::blockers() const {
  CameraMask mask;
  if (!opening_time()) return mask;
  for (int i = 0; i < kCameraCount; ++i) {
    mask[i] = cameras_[i].frames.empty() && cameras_[i].missed_in_a_row < kPatience;
  }
  return mask;
}

std::optional<Time> FramesetSynchronizer::opening_time() const {
  std::optional<Time> earliest;
  for (const CameraQueue& camera : cameras_) {
    if (camera.frames.empty()) continue;
    earliest = std::min(earliest.value_or(Time::max()), camera.frames.front().time);
  }
  return earliest;
}

bool FramesetSynchronizer::any_queue_full() const {
  return std::ranges::any_of(cameras_,
                             [](const CameraQueue& camera) { return camera.frames.full(); });
}

CameraMask FramesetSynchronizer::members(Time opening) const {
  CameraMask mask;
  for (int i = 0; i < kCameraCount; ++i) {
    const boost::circular_buffer<Frame>& frames = cameras_[i].frames;
    mask[i] = !frames.empty() && frames.front().time <= opening + config_.tolerance;
  }
  return mask;
}

Frameset FramesetSynchronizer::emit(Time opening, CameraMask found, CameraMask waited_for) {
  Frameset set;
  set.time = opening;
  set.present = found;
  for (int i = 0; i < kCameraCount; ++i) {
    CameraQueue& camera = cameras_[i];
    if (found[i]) {
      set.frames[i] = camera.pop();
      set.spread = std::max(set.spread, set.frames[i].time - opening);
      ++camera.counters.emitted;
      continue;
    }
    ++camera.counters.missing;
    camera.missed_in_a_row = std::min(camera.missed_in_a_row + 1, kPatience);
    if (waited_for[i]) ++camera.counters.waited_for;
  }
  return set;
}

void FramesetSynchronizer::discard(CameraMask found) {
  for (int i = 0; i < kCameraCount; ++i) {
    if (!found[i]) continue;
    cameras_[i].pop();
    ++cameras_[i].counters.unmatched;
  }
}

}  // namespace bevloc::drivers
