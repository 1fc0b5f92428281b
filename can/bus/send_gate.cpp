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
  const int64_t handed_over_ns = slot->handed_over_ns;
  if (handed_over_ns != kNone && now - Time(Duration(handed_over_ns)) < kGiveUp) return false;
  slot->handed_over_ns = now.time_since_epoch().count();
  return true;
}

void SendGate::leave(uint32_t id) {
  if (Slot* slot = find(id)) slot->handed_over_ns = kNone;
}

std::optional<Duration> SendGate::confirm(uint32_t id, Time echoed) {
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
