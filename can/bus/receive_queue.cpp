#include "can/bus/receive_queue.h"

#include <algorithm>
#include <cassert>

namespace bevloc::can {

ReceiveQueue::ReceiveQueue(size_t capacity) : frames_(capacity) {
  assert(capacity > 0);
}

bool ReceiveQueue::push(const ReceivedFrame& frame) {
  const bool full = frames_.full();
  if (full) {
    const auto same_id = std::ranges::find_if(
        frames_, [&](const ReceivedFrame& waiting) { return waiting.frame.id == frame.frame.id; });
    frames_.erase(same_id != frames_.end() ? same_id : frames_.begin());
  }
  frames_.push_back(frame);
  return !full;
}

std::optional<ReceivedFrame> ReceiveQueue::pop() {
  if (frames_.empty()) return std::nullopt;
  const ReceivedFrame frame = frames_.front();
  frames_.pop_front();
  return frame;
}

}  // namespace bevloc::can
