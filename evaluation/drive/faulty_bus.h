// A CAN endpoint with the faults of the simulated bus.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "can/bus/bus.h"
#include "can/bus/receive_clock.h"
#include "drivers/clock/clock.h"
#include "sim/faults/fault_board.h"
#include "sim/random.h"

namespace bevloc::evaluation {

/// Passes everything on while there is no fault. Threads: as Bus demands.
class FaultyBus final : public can::Bus {
 public:
  /// The clock must outlive the bus. `seed` is the seed of the drive. It chooses the lost frames.
  FaultyBus(std::unique_ptr<can::Bus> bus, std::shared_ptr<const sim::FaultBoard> faults,
            const drivers::Clock& clock, Time drive_start, uint64_t seed);

  can::SendResult send(const can::Frame& frame, Time now) override;
  std::optional<can::ReceivedFrame> receive() override;
  bool wait(Duration timeout) override;
  can::BusCounters counters() const override;
  can::BusCondition condition() const override;

 private:
  std::vector<sim::Fault> active(Time time) const;
  void hang(sim::FaultKind kind) const;
  void restamp(can::ReceivedFrame& received);

  const std::unique_ptr<can::Bus> bus_;
  const std::shared_ptr<const sim::FaultBoard> faults_;
  const drivers::Clock& clock_;
  const Time drive_start_;
  std::deque<can::Frame> held_;      // only for the sending thread
  sim::Random send_random_;          // only for the sending thread
  sim::Random receive_random_;       // only for the receiving thread
  can::ReceiveClock receive_clock_;  // only for the receiving thread
  std::atomic<uint64_t> send_bus_down_{0};
  std::atomic<uint64_t> send_expired_{0};
};

}  // namespace bevloc::evaluation
