#include "can/bus/send_gate.h"

#include <algorithm>
#include <cassert>

namespace bevloc::can {

SendGate::SendGate(std::span<const uint32_t> ids) : count_(ids.size()) {
  assert(ids.size() <= kMaxIds);
  for (size_t i = 0; i < count_; ++i) slots_[i].id = ids[i];
}

bool SendGate::enter(uint32_t id, Time now) {
  Slot* slot = find(id);
  if (slot == nullptr) return true;
  if (is_stalled(now)) return false;
  const int64_t handed_over_ns = slot->handed_over_ns;
  const int64_t alive_ns = alive_ns_;
  const bool handed_over = handed_over_ns != kNone;
  const bool lost =
      handed_over && alive_ns != kNone && alive_ns - handed_over_ns >= kGiveUp.count();
  if (handed_over && !lost) return false;
  slot->handed_over_ns = now.time_since_epoch().count();
  return true;
}

void SendGate::leave(uint32_t id) {
  if (Slot* slot = find(id)) slot->handed_over_ns = kNone;
}

void SendGate::note_alive(Time now) {
  alive_ns_ = now.time_since_epoch().count();
}

bool SendGate::is_stalled(Time now) const {
  const int64_t limit_ns = (now - kStall).time_since_epoch().count();
  const int64_t alive_ns = alive_ns_;
  if (alive_ns != kNone && alive_ns > limit_ns) return false;
  return std::any_of(slots_.begin(), slots_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const Slot& slot) {
                       const int64_t handed_over_ns = slot.handed_over_ns;
                       return handed_over_ns != kNone && handed_over_ns < limit_ns;
                     });
}

std::optional<Duration> SendGate::confirm(uint32_t id, Time echoed) {
  note_alive(echoed);
  Slot* slot = find(id);
  if (slot == nullptr) return std::nullopt;
  const int64_t handed_over_ns = slot->handed_over_ns.exchange(kNone);
  if (handed_over_ns == kNone) return std::nullopt;
  return std::max(Duration::zero(), echoed - Time(Duration(handed_over_ns)));
}

void SendGate::reset() {
  for (Slot& slot : slots_) slot.handed_over_ns = kNone;
}

SendGate::Slot* SendGate::find(uint32_t id) {
  const auto end = slots_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto found =
      std::find_if(slots_.begin(), end, [&](const Slot& slot) { return slot.id == id; });
  return found == end ? nullptr : &*found;
}

}  // namespace bevloc::can
