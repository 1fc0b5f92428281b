#include "can/bus/send_queue.h"

#include <algorithm>

namespace bevloc::can {

bool SendQueue::push(const Frame& frame, Time now) {
  const auto same =
      std::ranges::find_if(slots_, [&](const Slot& slot) { return slot.frame.id == frame.id; });
  if (same != slots_.end()) {
    *same = {frame, now};
    return false;
  }
  const bool full = slots_.size() == capacity_;
  if (full) slots_.erase(std::ranges::min_element(slots_, {}, &Slot::pushed));
  slots_.push_back({frame, now});
  return !full;
}

size_t SendQueue::drop_older_than(Time limit) {
  return std::erase_if(slots_, [&](const Slot& slot) { return slot.pushed < limit; });
}

bool SendQueue::holds(uint32_t id) const {
  return std::ranges::any_of(slots_, [&](const Slot& slot) { return slot.frame.id == id; });
}

}  // namespace bevloc::can
