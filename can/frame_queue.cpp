#include "can/frame_queue.h"

#include <cassert>

namespace bevloc::can {

FrameQueue::FrameQueue(size_t capacity) : slots_(capacity) {
  assert(capacity > 0);
}

bool FrameQueue::push(const ReceivedFrame& frame) {
  const bool full = size_ == slots_.size();
  if (full) {
    size_t victim = 0;
    for (size_t i = 0; i < size_; ++i) {
      if (at(i).frame.id == frame.frame.id) {
        victim = i;
        break;
      }
    }
    erase(victim);
  }
  at(size_++) = frame;
  return !full;
}

std::optional<ReceivedFrame> FrameQueue::pop() {
  if (empty()) return std::nullopt;
  const ReceivedFrame frame = at(0);
  first_ = (first_ + 1) % slots_.size();
  --size_;
  return frame;
}

void FrameQueue::erase(size_t position) {
  for (size_t i = position; i + 1 < size_; ++i) at(i) = at(i + 1);
  --size_;
}

}  // namespace bevloc::can
