// What the rest of the project knows about a CAN bus.
#pragma once

#include <cstdint>
#include <optional>

#include "can/bus_condition.h"
#include "can/frame.h"
#include "common/time.h"

namespace bevloc::can {

enum class SendResult : uint8_t {
  kSent,     ///< handed to the controller's queue
  kWaiting,  ///< no room there yet: kept until there is, until a newer one of its id, or too old
  kBusDown,  ///< the interface is down or gone; the frame is not kept
};

/// Totals since the endpoint was opened, but for send_waiting. Every frame that send() was given is
/// in one of the first five.
struct BusCounters {
  uint64_t sent = 0;
  uint64_t send_waiting = 0;      ///< at this moment
  uint64_t send_replaced = 0;     ///< a newer frame came before there was room
  uint64_t send_expired = 0;      ///< too old before there was room
  uint64_t send_bus_down = 0;     ///< not sent because the bus was down
  uint64_t confirmed = 0;         ///< own frames that were on the wire, where the bus tells
  uint64_t received = 0;          ///< frames that receive() gave out
  uint64_t receive_dropped = 0;   ///< lost because receive() was not called in time
  uint64_t receive_ignored = 0;   ///< extended, remote or malformed frames
  uint64_t hardware_stamped = 0;  ///< of the received, those with a time from the controller
  uint64_t software_stamped = 0;  ///< and those with a time from the kernel
  uint64_t error_frames = 0;      ///< error reports of the controller
  uint64_t bus_off = 0;           ///< of those, how often the controller left the bus
  uint64_t reopened = 0;          ///< how often the interface was gone and found again
  Duration confirmation_total{};  ///< from send() to the wire, summed over the confirmed frames
  Duration confirmation_max{};
};

/// One endpoint on a CAN bus. Nothing here blocks but wait(), and nothing allocates.
/// Threads: one may send while another waits and receives; counters() and condition() are for any.
/// Who sends must see to it that somebody receives: confirmations and the end of a fault are
/// noticed there.
class Bus {
 public:
  virtual ~Bus() = default;

  /// Sends at once if there is room, after what has waited longer. `now` is the time that frames
  /// age by, and stamps the frame on a bus that has no clock of its own (the mock).
  virtual SendResult send(const Frame& frame, Time now) = 0;

  /// The oldest frame that others sent and that was not given out yet, with its time of arrival.
  virtual std::optional<ReceivedFrame> receive() = 0;

  /// Waits until receive() has something to do or the time is up; says which. The time is real
  /// time, on a mock bus too. A thread that is to end within t waits at most t at once.
  virtual bool wait(Duration timeout) = 0;

  virtual BusCounters counters() const = 0;
  virtual BusCondition condition() const = 0;
};

}  // namespace bevloc::can
