// A bounded queue of received CAN frames that keeps the newest frame of each identifier.
#pragma once

#include <cstddef>
#include <optional>

#include <boost/circular_buffer.hpp>

#include "can/bus/frame.h"

namespace bevloc::can {

/// First in, first out. When the queue is full, a push drops the oldest frame with the same
/// identifier, or the oldest frame of all if no frame has this identifier. The new frame goes to
/// the end of the queue. Allocates in its constructor only. One thread.
class ReceiveQueue {
 public:
  explicit ReceiveQueue(size_t capacity);

  /// Returns false when an older frame was dropped to make room.
  bool push(const ReceivedFrame& frame);
  std::optional<ReceivedFrame> pop();
  bool empty() const { return frames_.empty(); }

 private:
  boost::circular_buffer<ReceivedFrame> frames_;
};

}  // namespace bevloc::can
