#include "drivers/mock/mock_schedule.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace bevloc::drivers {

MockSchedule::MockSchedule(const CameraTiming& timing, int camera,
                           std::shared_ptr<const sim::FaultBoard> faults)
    : timing_(timing), camera_(camera), faults_(std::move(faults)) {
  assert(timing.period > Duration::zero());
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
  if (active(sim::FaultKind::kCameraOutOfOrder, index)) {
    held_back_ = delivery;
    return next_exposed();
  }
  if (active(sim::FaultKind::kCameraDuplicate, index)) held_back_ = delivery;
  return delivery;
}

/// Returns the next exposure that is not dropped.
Delivery MockSchedule::next_exposed() {
  while (true) {
    const uint64_t index = index_++;
    if (!active(sim::FaultKind::kCameraDrop, index)) return delivery_of(index);
  }
}

std::optional<sim::Fault> MockSchedule::active(sim::FaultKind kind, uint64_t index) const {
  if (!faults_) return std::nullopt;
  const double time_s = to_seconds(exposure_start(index) - timing_.drive_start);
  for (const sim::Fault& fault : faults_->active_on_camera(camera_, time_s)) {
    const auto every = static_cast<uint64_t>(std::max(1.0, fault.amounts.every));
    if (fault.kind == kind && (index + 1) % every == 0) return fault;
  }
  return std::nullopt;
}

Time MockSchedule::exposure_start(uint64_t index) const {
  return timing_.drive_start + timing_.phase + static_cast<int64_t>(index) * timing_.period;
}

/// The moment that the picture of an exposure shows.
Time MockSchedule::scene_time(uint64_t index) const {
  const Time start = exposure_start(index);
  if (const auto frozen = active(sim::FaultKind::kCameraFrozen, index)) {
    return std::min(start, timing_.drive_start + from_seconds(frozen->from_s));
  }
  if (const auto loop = active(sim::FaultKind::kCameraLoop, index)) {
    const Duration until_loop =
        timing_.drive_start + from_seconds(loop->from_s) - exposure_start(0);
    const auto periods_up =
        (until_loop.count() + timing_.period.count() - 1) / timing_.period.count();
    const auto first = static_cast<uint64_t>(std::max<int64_t>(0, periods_up));
    return exposure_start(first + (index - first) % static_cast<uint64_t>(loop->amounts.pictures));
  }
  return start;
}

Delivery MockSchedule::delivery_of(uint64_t index) const {
  const Time start = exposure_start(index);
  Delivery delivery{index - first_index_, start, scene_time(index), start + timing_.readout};
  if (const auto late = active(sim::FaultKind::kCameraLate, index)) {
    delivery.due += from_milliseconds(late->amounts.delay_ms);
  }
  if (const auto shift = active(sim::FaultKind::kCameraTimeShift, index)) {
    delivery.exposure_start += from_milliseconds(shift->amounts.shift_ms);
  }
  delivery.lost = active(sim::FaultKind::kCameraDead, index).has_value();
  return delivery;
}

}  // namespace bevloc::drivers
