// The counters of a bus endpoint as atomics, which are readable from any thread.
#pragma once

#include <atomic>
#include <cstdint>

#include "can/bus/bus.h"

namespace bevloc::can {

struct AtomicBusCounters {
  std::atomic<uint64_t> sent{0};
  std::atomic<uint64_t> send_waiting{0};
  std::atomic<uint64_t> send_replaced{0};
  std::atomic<uint64_t> send_expired{0};
  std::atomic<uint64_t> send_bus_down{0};
  std::atomic<uint64_t> confirmed{0};
  std::atomic<uint64_t> received{0};
  std::atomic<uint64_t> receive_dropped{0};
  std::atomic<uint64_t> receive_overrun{0};
  std::atomic<uint64_t> receive_ignored{0};
  std::atomic<uint64_t> hardware_stamped{0};
  std::atomic<uint64_t> software_stamped{0};
  std::atomic<uint64_t> error_frames{0};
  std::atomic<uint64_t> bus_off{0};
  std::atomic<uint64_t> reopened{0};
  std::atomic<Duration> confirmation_total{Duration::zero()};
  std::atomic<Duration> confirmation_max{Duration::zero()};

  /// Call it from one thread only, because the update of the two durations is not atomic.
  void count_confirmation(Duration latency) {
    ++confirmed;
    confirmation_total = confirmation_total.load() + latency;
    if (latency > confirmation_max.load()) confirmation_max = latency;
  }

  BusCounters snapshot() const {
    return {.sent = sent,
            .send_waiting = send_waiting,
            .send_replaced = send_replaced,
            .send_expired = send_expired,
            .send_bus_down = send_bus_down,
            .confirmed = confirmed,
            .received = received,
            .receive_dropped = receive_dropped,
            .receive_overrun = receive_overrun,
            .receive_ignored = receive_ignored,
            .hardware_stamped = hardware_stamped,
            .software_stamped = software_stamped,
            .error_frames = error_frames,
            .bus_off = bus_off,
            .reopened = reopened,
            .confirmation_total = confirmation_total,
            .confirmation_max = confirmation_max};
  }
};

}  // namespace bevloc::can
