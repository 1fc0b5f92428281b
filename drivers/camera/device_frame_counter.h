// Counts delivered and lost frames from the sequence numbers of a device.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "drivers/camera/camera.h"

namespace bevloc::drivers {

/// Thread-bound: called from the camera's own thread. counters() is readable from any thread.
class DeviceFrameCounter {
 public:
  /// start() calls it, because the device begins its sequence again.
  void restart() {
    latest_.reset();
    sequence_ = 0;
    was_starved_ = false;
  }

  /// Takes the device's sequence number of a frame that arrived. The number may wrap around. A gap
  /// in the numbers shows missing frames. They count as no_buffer if the user held all buffers
  /// after the previous frame, and otherwise as lost. A number that is lower than the previous one
  /// shows that the device began again, for example after a suspend. The number of lost frames is
  /// then unknown, and none is counted. Returns the sequence number of the frame since restart().
  uint64_t arrived(uint32_t device_sequence) {
    constexpr uint32_t kLargestStep = UINT32_MAX / 2;
    uint32_t step = latest_ ? device_sequence - *latest_ : 0;
    if (step > kLargestStep) step = 1;
    latest_ = device_sequence;
    sequence_ += step;
    if (step > 1) (was_starved_ ? no_buffer_ : lost_) += step - 1;
    was_starved_ = false;
    return sequence_;
  }

  /// Counts a delivered frame. `is_last_buffer` says that the user now holds all buffers.
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
