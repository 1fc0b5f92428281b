// The frames that wait for room in the kernel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "can/frame.h"

namespace bevloc::can {

/// Holds at most one frame of each identifier: a newer one takes the place of the one that waits,
/// so that nobody gets ahead in the queue by sending more often. Allocates in its constructor only.
/// Not thread-safe.
class SendQueue {
 public:
  enum class Answer : uint8_t {
    kTaken,   ///< the frame has been sent
    kLater,   ///< not this one, but others may go
    kNoRoom,  ///< nor any other
  };

  explicit SendQueue(size_t capacity) : capacity_(capacity) { slots_.reserve(capacity); }

  /// False when an older frame was lost for this one: that of its identifier, or the oldest of all
  /// when the queue is full.
  bool push(const Frame& frame, Time now);

  /// Removes what was pushed before `limit`; says how many.
  size_t drop_older_than(Time limit);

  /// Offers the frames in their order to `take`, an Answer(const Frame&), until one finds no room.
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
