// The interface of a CAN bus endpoint.
#pragma once

#include <cstdint>
#include <optional>

#include "can/bus/bus_condition.h"
#include "can/bus/frame.h"
#include "common/time.h"

namespace bevloc::can {

enum class SendResult : uint8_t {
  kSent,     ///< the frame was handed to the controller's queue
  kWaiting,  ///< there is no room yet: the frame is kept until it is sent, replaced or expired
  kBusDown,  ///< the interface is down or gone; the frame is not kept
};

/// Totals since the endpoint was opened, except send_waiting. Every frame passed to send() is
/// counted in exactly one of the first five.
struct BusCounters {
  uint64_t sent = 0;
  uint64_t send_waiting = 0;      ///< frames that wait for room at this moment
  uint64_t send_replaced = 0;     ///< dropped: a newer frame came before there was room
  uint64_t send_expired = 0;      ///< dropped: too old before there was room
  uint64_t send_bus_down = 0;     ///< dropped: the bus was down
  uint64_t confirmed = 0;         ///< own frames that were on the wire, if the bus reports that
  uint64_t received = 0;          ///< frames that receive() returned
  uint64_t receive_dropped = 0;   ///< lost because receive() was not called in time
  uint64_t receive_overrun = 0;   ///< reports of the controller that it had lost received frames
  uint64_t receive_ignored = 0;   ///< extended, remote or malformed frames
  uint64_t hardware_stamped = 0;  ///< received frames with a time from the controller
  uint64_t software_stamped = 0;  ///< received frames with a time from the kernel
  uint64_t error_frames = 0;      ///< error reports of the controller
  uint64_t bus_off = 0;           ///< error reports that say that the controller went bus-off
  uint64_t reopened = 0;          ///< number of times that a lost interface was found again
  Duration confirmation_total{};  ///< time from send() to the wire, summed over confirmed frames
  Duration confirmation_max{};    ///< longest time from send() to the wire

  uint64_t send_dropped() const { return send_replaced + send_expired + send_bus_down; }
  /// Returns 0 if no frame was confirmed.
  double confirmation_mean_s() const {
    return confirmed == 0 ? 0.0 : to_seconds(confirmation_total) / static_cast<double>(confirmed);
  }
};

/// One endpoint on a CAN bus. Only wait() blocks. Nothing allocates. An endpoint that sends must
/// also receive, because receive() detects confirmations and the end of a fault.
/// Thread-bound: send() is called from the sending thread, wait() and receive() from the receiving
/// thread, which may be the same one. counters() and condition() are readable from any thread.
class Bus {
 public:
  virtual ~Bus() = default;

  /// Sends the waiting frames and then this one, as far as there is room. `now` determines the age
  /// of waiting frames, and is the frame's time on a bus without a clock (the mock).
  virtual SendResult send(const Frame& frame, Time now) = 0;

  /// Returns the oldest unread frame of another endpoint with its time of arrival, if there is one.
  virtual std::optional<ReceivedFrame> receive() = 0;

  /// Waits until receive() has work to do (true) or the timeout has passed (false). The timeout is
  /// real time, also on a mock bus.
  virtual bool wait(Duration timeout) = 0;

  virtual BusCounters counters() const = 0;
  virtual BusCondition condition() const = 0;
};

}  // namespace bevloc::can
