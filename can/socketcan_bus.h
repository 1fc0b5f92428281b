// A CAN interface of the Linux kernel (SocketCAN, Documentation/networking/can.rst).
#pragma once

#include <memory>
#include <string>

#include "can/bus.h"
#include "can/bus_counting.h"
#include "can/controller_monitor.h"
#include "can/receive_clock.h"
#include "can/send_gate.h"
#include "can/send_queue.h"
#include "can/socketcan_codec.h"
#include "can/socketcan_link.h"
#include "common/result.h"

namespace bevloc::can {

/// A raw CAN socket. Frames are stamped when they arrive, by the controller or else by the kernel,
/// and converted to steady time (CLOCK_MONOTONIC). Bit rate, restart after bus-off and queue length
/// belong to the interface and are set outside.
class SocketCanBus final : public Bus {
 public:
  /// Fails when the kernel has no CAN or no such interface.
  static Result<std::unique_ptr<SocketCanBus>> open(const std::string& interface,
                                                    const SocketCanOptions& options = {});

  /// Takes over an open datagram descriptor that carries the kernel's frames, such as a socket pair
  /// where the kernel has no CAN. It gives no time stamps, so frames carry the time of receive().
  static std::unique_ptr<SocketCanBus> from_descriptor(int descriptor);

  SendResult send(const Frame& frame, Time now) override;
  std::optional<ReceivedFrame> receive() override;
  bool wait(Duration timeout) override;
  BusCounters counters() const override { return counters_.snapshot(); }
  BusCondition condition() const override;

 private:
  SocketCanBus(std::unique_ptr<SocketCanLink> link, const SocketCanOptions& options);

  SendQueue::Answer write(const Frame& frame);
  void repair();
  void take_error(const ErrorFrame& error);
  void take_echo(const Frame& frame, Time echoed);
  ReceivedFrame stamped(const Frame& frame, const Ancillary& ancillary);

  const std::unique_ptr<SocketCanLink> link_;
  const Duration max_send_age_;
  SendQueue queue_;  // used by the sending thread alone
  SendGate gate_;
  ReceiveClock clock_;  // used by the receiving thread alone
  ControllerMonitor monitor_;
  AtomicBusCounters counters_;
};

}  // namespace bevloc::can
