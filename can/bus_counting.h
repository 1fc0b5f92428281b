// The counters of a bus endpoint, written by its threads and read by any.
#pragma once

#include <atomic>
#include <cstdint>

#include "can/bus.h"

namespace bevloc::can {

struct AtomicBusCounters {
  std::atomic<uint64_t> sent{0};
  std::atomic<uint64_t> send_dropped{0};
  std::atomic<uint64_t> send_bus_down{0};
  std::atomic<uint64_t> received{0};
  std::atomic<uint64_t> receive_dropped{0};
  std::atomic<uint64_t> receive_ignored{0};
  std::atomic<uint64_t> error_frames{0};
  std::atomic<uint64_t> bus_off{0};

  SendResult count(SendResult result) {
    switch (result) {
      case SendResult::kSent:
        ++sent;
        break;
      case SendResult::kDropped:
        ++send_dropped;
        break;
      case SendResult::kBusDown:
        ++send_bus_down;
        break;
    }
    return result;
  }

  BusCounters snapshot() const {
    return {.sent = sent,
            .send_dropped = send_dropped,
            .send_bus_down = send_bus_down,
            .received = received,
            .receive_dropped = receive_dropped,
            .receive_ignored = receive_ignored,
            .error_frames = error_frames,
            .bus_off = bus_off};
  }
};

}  // namespace bevloc::can
