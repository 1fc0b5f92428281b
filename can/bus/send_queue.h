// The queue of frames that wait for room in the kernel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "can/bus/frame.h"

namespace bevloc::can {

/// Holds at most one frame of each identifier. A newer frame takes the place of the waiting one, so
/// that a message does not lose its turn when it is sent again. Allocates in its constructor only.
/// One thread.
class SendQueue {
 public:
  enum class Answer : uint8_t {
    kTaken,   ///< the frame was sent
    kLater,   ///< this frame has to wait, but others may be sent
    kNoRoom,  ///< no frame can be sent now
  };

  explicit SendQueue(size_t capacity) : capacity_(capacity) { slots_.reserve(capacity); }

  /// Returns false when an older frame was dropped: the one with the same identifier, or the oldest
  /// of all when the queue is full.
  bool push(const Frame& frame, Time now);

  /// Removes the frames that were pushed before `limit` and returns their number.
  size_t drop_older_than(Time limit);

  /// Offers the frames in order to `take`, an Answer(const Frame&), until it answers kNoRoom.
  template <typename Take>
  void offer(Take&& take);

  bool holds(uint32_t id) const;
  size_t size() const { return slots_.size(); }
  void clear() { slots_.clear(); }

 private:
  struct Slot {
    Frame frame;
    Time pushed;
  };

  size_t capacity_;
  std::vector<Slot> slots_;
};

template <typename Take>
void SendQueue::offer(Take&& take) {
  size_t kept = 0;
  bool room = true;
  for (size_t i = 0; i < slots_.size(); ++i) {
    if (room) {
      const Answer answer = take(slots_[i].frame);
      if (answer == Answer::kTaken) continue;
      room = answer == Answer::kLater;
    }
    if (kept != i) slots_[kept] = slots_[i];
    ++kept;
  }
  slots_.erase(slots_.begin() + static_cast<std::ptrdiff_t>(kept), slots_.end());
}

}  // namespace bevloc::can
