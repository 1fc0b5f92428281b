// What the rest of the project knows about a CAN bus.
#pragma once

#include <cstdint>
#include <optional>

#include "can/frame.h"
#include "common/time.h"

namespace bevloc::can {

enum class SendResult : uint8_t {
  kSent,     ///< handed to the controller's queue
  kDropped,  ///< the queue is full: nobody acknowledges, or the bus is overloaded
  kBusDown,  ///< the interface is down, gone or bus-off
};

/// Totals since the endpoint was opened.
struct BusCounters {
  uint64_t sent = 0;
  uint64_t send_dropped = 0;     ///< send() said kDropped
  uint64_t send_bus_down = 0;    ///< send() said kBusDown
  uint64_t received = 0;         ///< frames that receive() gave out
  uint64_t receive_dropped = 0;  ///< lost because receive() was not called in time
  uint64_t receive_ignored = 0;  ///< extended, remote, FD or malformed frames
  uint64_t error_frames = 0;     ///< error reports of the controller
  uint64_t bus_off = 0;          ///< of those, how often the controller left the bus
};

/// One endpoint on a CAN bus. Nothing here blocks but wait(), and nothing allocates.
/// Threads: one may send while another waits and receives; counters() is for any thread.
class Bus {
 public:
  virtual ~Bus() = default;

  /// Sends at once or not at all. A frame that found no room is not kept: the next cycle has a
  /// newer one. `now` stamps the frame on a bus that has no clock of its own (the mock).
  virtual SendResult send(const Frame& frame, Time now) = 0;

  /// The oldest frame that others sent and that was not given out yet, with its time of arrival.
  virtual std::optional<ReceivedFrame> receive() = 0;

  /// Waits until receive() has something to do or the time is up; says which. The time is real
  /// time, on a mock bus too. A thread that is to end within t waits at most t at once.
  virtual bool wait(Duration timeout) = 0;

  virtual BusCounters counters() const = 0;
};

}  // namespace bevloc::can
