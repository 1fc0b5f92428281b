#include "drivers/mock/mock_schedule.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace bevloc::drivers {

MockSchedule::MockSchedule(const CameraTiming& timing, std::vector<CameraFault> faults)
    : timing_(timing), faults_(std::move(faults)) {
  assert(timing.period > Duration::zero());
  for ([[maybe_unused]] const CameraFault& fault : faults_) {
    assert(fault.every >= 1 && fault.from_s <= fault.until_s && fault.delay >= Duration::zero());
  }
}

void MockSchedule::restart(Time now) {
  const Duration since_first = now - exposure_start(0);
  const auto periods_up =
      (since_first.count() + timing_.period.count() - 1) / timing_.period.count();
  first_index_ = since_first > Duration::zero() ? static_cast<uint64_t>(periods_up) : 0;
  index_ = first_index_;
  held_back_.reset();
  latest_due_ = Time::min();
}

Delivery MockSchedule::next() {
  Delivery delivery = next_in_order();
  // A frame cannot overtake the late frame before it.
  delivery.due = latest_due_ = std::max(latest_due_, delivery.due);
  return delivery;
}

Delivery MockSchedule::next_in_order() {
  if (held_back_) return *std::exchange(held_back_, std::nullopt);
  const Delivery delivery = next_exposed();
  const uint64_t index = delivery.sequence + first_index_;
  if (active(CameraFaultKind::kSwap, index) != nullptr) {
    held_back_ = delivery;
    return next_exposed();
  }
  if (active(CameraFaultKind::kDuplicate, index) != nullptr) held_back_ = delivery;
  return delivery;
}

/// Returns the next exposure that is not lost.
Delivery MockSchedule::next_exposed() {
  while (true) {
    const uint64_t index = index_;
    const CameraFault* dead = active(CameraFaultKind::kDead, index);
    if (dead != nullptr && std::isinf(dead->until_s)) {
      Delivery never = delivery_of(index);
      never.due = Time::max();
      return never;
    }
    ++index_;
    if (dead == nullptr && active(CameraFaultKind::kDrop, index) == nullptr) {
      return delivery_of(index);
    }
  }
}

const CameraFault* MockSchedule::active(CameraFaultKind kind, uint64_t index) const {
  const double drive_time_s = to_seconds(exposure_start(index) - timing_.drive_start);
  for (const CameraFault& fault : faults_) {
    const bool counts = (index + 1) % static_cast<uint64_t>(fault.every) == 0;
    if (fault.kind == kind && drive_time_s >= fault.from_s && drive_time_s < fault.until_s &&
        counts) {
      return &fault;
    }
  }
  return nullptr;
}

Time MockSchedule::exposure_start(uint64_t index) const {
  return timing_.drive_start + timing_.phase + static_cast<int64_t>(index) * timing_.period;
}

Delivery MockSchedule::delivery_of(uint64_t index) const {
  const Time start = exposure_start(index);
  Delivery delivery{index - first_index_, start, start, start + timing_.readout};
  if (const CameraFault* late = active(CameraFaultKind::kLate, index)) delivery.due += late->delay;
  if (const CameraFault* frozen = active(CameraFaultKind::kFrozen, index)) {
    delivery.scene_time = std::min(start, timing_.drive_start + from_seconds(frozen->from_s));
  }
  return delivery;
}

}  // namespace bevloc::drivers
