#include "evaluation/drive/faulty_bus.h"

#include <algorithm>
#include <utility>

namespace bevloc::evaluation {
namespace {

using sim::FaultKind;

/// CLOCK_REALTIME when the simulated steady clock shows 0. Any other value would do.
constexpr std::chrono::seconds kWallClockAtZero{1'600'000'000};
/// How long after its arrival a frame is read from the socket.
constexpr std::chrono::milliseconds kReadDelay{1};

const sim::Fault* fault_of(const std::vector<sim::Fault>& faults, FaultKind kind) {
  const auto found = std::ranges::find(faults, kind, &sim::Fault::kind);
  return found == faults.end() ? nullptr : &*found;
}

/// Whether a flood takes the place of this frame.
bool is_lost(const std::vector<sim::Fault>& faults, sim::Random& random) {
  const sim::Fault* flooded = fault_of(faults, FaultKind::kBusFlooded);
  return flooded != nullptr && random.chance(flooded->amounts.loss);
}

}  // namespace

FaultyBus::FaultyBus(std::unique_ptr<can::Bus> bus, std::shared_ptr<const sim::FaultBoard> faults,
                     const drivers::Clock& clock, Time drive_start, uint64_t seed)
    : bus_(std::move(bus)),
      faults_(std::move(faults)),
      clock_(clock),
      drive_start_(drive_start),
      send_random_(sim::seed_for(seed, "flooded send")),
      receive_random_(sim::seed_for(seed, "flooded receive")) {}

std::vector<sim::Fault> FaultyBus::active(Time time) const {
  return faults_->active(sim::FaultInput::kBus, to_seconds(time - drive_start_));
}

void FaultyBus::hang(FaultKind kind) const {
  faults_->hang(kind, 0, [this] { return to_seconds(clock_.now() - drive_start_); });
}

can::SendResult FaultyBus::send(const can::Frame& frame, Time now) {
  hang(FaultKind::kHangCanOut);
  const std::vector<sim::Fault> faults = active(now);
  if (fault_of(faults, FaultKind::kBusOff) != nullptr) {
    send_bus_down_.fetch_add(1, std::memory_order_relaxed);
    return can::SendResult::kBusDown;
  }
  if (const sim::Fault* alone = fault_of(faults, FaultKind::kBusNoAcknowledge)) {
    if (static_cast<double>(held_.size()) < alone->amounts.stale_frames) {
      held_.push_back(frame);
      return can::SendResult::kSent;
    }
    send_expired_.fetch_add(1, std::memory_order_relaxed);
    return can::SendResult::kWaiting;
  }
  for (; !held_.empty(); held_.pop_front()) bus_->send(held_.front(), now);
  if (is_lost(faults, send_random_)) {
    send_expired_.fetch_add(1, std::memory_order_relaxed);
    return can::SendResult::kWaiting;
  }
  return bus_->send(frame, now);
}

std::optional<can::ReceivedFrame> FaultyBus::receive() {
  hang(FaultKind::kHangCanIn);
  while (auto received = bus_->receive()) {
    const std::vector<sim::Fault> faults = active(received->received);
    const bool is_cut_off = fault_of(faults, FaultKind::kBusOff) != nullptr ||
                            fault_of(faults, FaultKind::kBusNoAcknowledge) != nullptr;
    if (is_cut_off || is_lost(faults, receive_random_)) continue;
    restamp(*received);
    return received;
  }
  return std::nullopt;
}

bool FaultyBus::wait(Duration timeout) {
  hang(FaultKind::kHangCanIn);
  return bus_->wait(timeout);
}

/// Stamps a frame as SocketCanBus does on a controller with a clock: by the wall clock and by the
/// controller's clock, which here shows the steady time.
void FaultyBus::restamp(can::ReceivedFrame& received) {
  const auto steps = faults_->all(sim::FaultInput::kClock);
  if (fault_of(steps, FaultKind::kWallClockStep) == nullptr) return;
  const auto wall_clock = [&](Time steady) {
    const double time_s = to_seconds(steady - drive_start_);
    auto wall = steady.time_since_epoch() + std::chrono::nanoseconds(kWallClockAtZero);
    for (const sim::Fault& fault : steps) {
      const bool is_stepped = fault.kind == FaultKind::kWallClockStep && fault.is_active(time_s);
      if (is_stepped) wall += from_seconds(fault.amounts.step_s);
    }
    return wall;
  };
  const Time arrived = received.received - kReadDelay;
  const can::KernelStamps stamps{wall_clock(arrived), arrived.time_since_epoch()};
  received.received =
      receive_clock_.to_steady(stamps, {received.received, wall_clock(received.received)}).time;
}

can::BusCounters FaultyBus::counters() const {
  can::BusCounters counters = bus_->counters();
  counters.send_bus_down += send_bus_down_.load(std::memory_order_relaxed);
  counters.send_expired += send_expired_.load(std::memory_order_relaxed);
  return counters;
}

can::BusCondition FaultyBus::condition() const {
  const std::vector<sim::Fault> faults = active(clock_.now());
  if (fault_of(faults, FaultKind::kBusOff) != nullptr) return {.state = can::BusState::kOff};
  if (fault_of(faults, FaultKind::kBusNoAcknowledge) != nullptr) {
    return {can::BusState::kPassive, static_cast<uint8_t>(can::BusFault::kNoAcknowledge)};
  }
  return bus_->condition();
}

}  // namespace bevloc::evaluation
