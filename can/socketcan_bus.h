// A CAN interface of the Linux kernel (SocketCAN, Documentation/networking/can.rst).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "can/bus.h"
#include "can/bus_counting.h"
#include "common/result.h"

namespace bevloc::can {

/// A raw CAN socket. Frames are stamped by the kernel when they arrive and converted to steady time
/// (CLOCK_MONOTONIC). Bit rate, restart after bus-off and queue length belong to the interface and
/// are set outside, by systemd-networkd.
class SocketCanBus final : public Bus {
 public:
  /// `accepted_ids` are the standard identifiers that the kernel lets through; none means all.
  /// Fails when the kernel has no CAN or no interface of that name.
  static Result<std::unique_ptr<SocketCanBus>> open(const std::string& interface,
                                                    const std::vector<uint32_t>& accepted_ids = {});

  /// Takes over an open datagram descriptor that carries `struct can_frame`, such as a socket pair
  /// where the kernel has no CAN. It gives no time stamps, so frames carry the time of receive().
  static std::unique_ptr<SocketCanBus> from_descriptor(int descriptor);

  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  SendResult send(const Frame& frame, Time now) override;
  std::optional<ReceivedFrame> receive() override;
  bool wait(Duration timeout) override;
  BusCounters counters() const override { return counters_.snapshot(); }

 private:
  explicit SocketCanBus(int descriptor) : descriptor_(descriptor) {}

  const int descriptor_;
  AtomicBusCounters counters_;
};

}  // namespace bevloc::can
