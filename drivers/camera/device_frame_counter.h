// Follows a device's own count of its frames.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "drivers/camera/camera.h"

namespace bevloc::drivers {

/// counters() from any thread, the rest from the camera's own.
class DeviceFrameCounter {
 public:
  /// A new start(): the device counts anew.
  void restart() {
    latest_.reset();
    sequence_ = 0;
    was_starved_ = false;
  }

  /// The device's count of a frame that arrived, which may wrap. What is missing before it was lost
  /// for want of a buffer if there was a moment without one, otherwise on the way here. Returns the
  /// frame's sequence number since restart().
  uint64_t arrived(uint32_t device_sequence) {
    const uint32_t step = latest_ ? device_sequence - *latest_ : 0;
    latest_ = device_sequence;
    sequence_ += step;
    if (step > 1) (was_starved_ ? no_buffer_ : lost_) += step - 1;
    was_starved_ = false;
    return sequence_;
  }

  void delivered(bool is_last_buffer) {
    ++delivered_;
    was_starved_ = is_last_buffer;
  }
  void damaged() { ++damaged_; }

  CameraCounters counters() const {
    return {.delivered = delivered_, .no_buffer = no_buffer_, .lost = lost_, .damaged = damaged_};
  }

 private:
  std::optional<uint32_t> latest_;
  uint64_t sequence_ = 0;
  bool was_starved_ = false;
  std::atomic<uint64_t> delivered_{0};
  std::atomic<uint64_t> no_buffer_{0};
  std::atomic<uint64_t> lost_{0};
  std::atomic<uint64_t> damaged_{0};
};

}  // namespace bevloc::drivers
