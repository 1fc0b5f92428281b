// A bounded queue of frames in which the newest of each identifier wins.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "can/frame.h"

namespace bevloc::can {

/// First in, first out. When it is full, a new frame takes the place of the oldest one with its
/// identifier, or else of the oldest one of all. Allocates in its constructor only. Not
/// thread-safe.
class FrameQueue {
 public:
  explicit FrameQueue(size_t capacity);

  /// False when an older frame was lost to make room.
  bool push(const ReceivedFrame& frame);
  std::optional<ReceivedFrame> pop();
  bool empty() const { return size_ == 0; }

 private:
  ReceivedFrame& at(size_t position) { return slots_[(first_ + position) % slots_.size()]; }
  void erase(size_t position);

  std::vector<ReceivedFrame> slots_;
  size_t first_ = 0;
  size_t size_ = 0;
};

}  // namespace bevloc::can
