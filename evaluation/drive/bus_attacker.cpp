#include "evaluation/drive/bus_attacker.h"

#include <cmath>

#include "common/se2.h"
#include "sim/sensors/odometry.h"

namespace bevloc::evaluation {
namespace {

constexpr double kMemory_s = 61.0;  ///< longer than the greatest age of a replayed frame
constexpr double kActPeriod_s = sim::OdometrySimulator::kPeriod_s;

}  // namespace

void BusAttacker::note(const can::Frame& frame, double elapsed_s) {
  noted_.push_back({frame, elapsed_s});
  while (noted_.front().elapsed_s < elapsed_s - kMemory_s) noted_.pop_front();
}

void BusAttacker::act(const sim::FaultBoard& faults, double elapsed_s, can::Bus& bus, Time now) {
  for (const sim::Fault& fault : faults.active(sim::FaultInput::kBus, elapsed_s)) {
    const sim::FaultAmounts& by = fault.amounts;
    if (fault.kind == sim::FaultKind::kBusFlooded) flood(by.rate_hz, elapsed_s, bus, now);
    if (fault.kind == sim::FaultKind::kBusForged) forge(by, bus, now);
    if (fault.kind == sim::FaultKind::kBusReplayed) replay(by.age_s, elapsed_s, bus, now);
  }
}

/// Frames with identifier 0 win every arbitration.
void BusAttacker::flood(double rate_hz, double elapsed_s, can::Bus& bus, Time now) const {
  const auto sent_until = [rate_hz](double time_s) { return std::llround(rate_hz * time_s); };
  const can::Frame first{.id = 0, .length = can::kMaxClassicLength};
  for (auto i = sent_until(elapsed_s - kActPeriod_s); i < sent_until(elapsed_s); ++i) {
    bus.send(first, now);
  }
}

void BusAttacker::forge(const sim::FaultAmounts& by, can::Bus& bus, Time now) {
  const OdometrySample forged{now, by.speed_mps, radians(by.yaw_rate_degps)};
  for (int skipped = 1; skipped < static_cast<int>(by.counter_step); ++skipped) {
    encoder_.odometry(forged);
  }
  for (const can::Frame& frame : encoder_.odometry(forged)) bus.send(frame, now);
}

void BusAttacker::replay(double age_s, double elapsed_s, can::Bus& bus, Time now) const {
  const auto tick = [](double time_s) { return std::llround(time_s / kActPeriod_s); };
  for (const Noted& noted : noted_) {
    if (tick(noted.elapsed_s + age_s) == tick(elapsed_s)) bus.send(noted.frame, now);
  }
}

}  // namespace bevloc::evaluation
