// A CAN bus on an interface of the Linux kernel (SocketCAN, Documentation/networking/can.rst).
#pragma once

#include <memory>
#include <string>

#include "can/bus/bus.h"
#include "can/bus/bus_counting.h"
#include "can/bus/controller_monitor.h"
#include "can/bus/receive_clock.h"
#include "can/bus/send_gate.h"
#include "can/bus/send_queue.h"
#include "can/bus/socketcan_codec.h"
#include "can/bus/socketcan_link.h"
#include "common/result.h"

namespace bevloc::can {

/// A raw CAN socket. The controller, or else the kernel, stamps arriving frames; the stamps are
/// converted to steady time (CLOCK_MONOTONIC). Bit rate, restart after bus-off and queue length are
/// settings of the interface (`ip link`), not of this class.
class SocketCanBus final : public Bus {
 public:
  /// Fails when the kernel has no CAN support or no interface of this name.
  static Result<std::unique_ptr<SocketCanBus>> open(const std::string& interface,
                                                    const SocketCanOptions& options = {});

  /// Takes ownership of an open datagram descriptor that carries frames in the kernel's format,
  /// such as a socket pair on a kernel without CAN. It delivers no time stamps, so frames carry the
  /// time of receive(). Nor does it deliver echoes, so frames with confirmed identifiers are held
  /// back after the first one.
  static std::unique_ptr<SocketCanBus> from_descriptor(int descriptor,
                                                       const SocketCanOptions& options = {});

  SendResult send(const Frame& frame, Time now) override;
  std::optional<ReceivedFrame> receive() override;
  bool wait(Duration timeout) override;
  BusCounters counters() const override { return counters_.snapshot(); }
  BusCondition condition() const override;

 private:
  SocketCanBus(std::unique_ptr<SocketCanLink> link, const SocketCanOptions& options);

  SendQueue::Answer write(const Frame& frame);
  void repair();
  void note_down();
  void free_places_of_discarded();
  void take_error(const ErrorFrame& error);
  void note_traffic(const Frame& frame, bool is_echo);
  ReceivedFrame stamped(const Frame& frame, const Ancillary& ancillary);

  const std::unique_ptr<SocketCanLink> link_;
  const Duration max_send_age_;
  SendQueue queue_;  // used by the sending thread only
  SendGate gate_;
  /// Whether the controller has discarded frames that have a place in the gate. Used by the
  /// receiving thread only.
  bool has_discarded_ = false;
  ReceiveClock clock_;  // used by the receiving thread only
  ControllerMonitor monitor_;
  AtomicBusCounters counters_;
};

}  // namespace bevloc::can
