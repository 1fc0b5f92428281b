// Endpoints of the configured CAN bus.
#pragma once

#include <memory>

#include "can/mock_bus.h"
#include "can/socketcan_link.h"
#include "firmware/config.h"

namespace bevloc::firmware {

class BusFactory {
 public:
  explicit BusFactory(const CanConfig& config) : config_(config) {}

  /// One more node on the bus, which hears all of it: on the mock wire, or a socket on the
  /// interface. Fails where the interface cannot be opened.
  Result<std::unique_ptr<can::Bus>> connect();

  /// The appliance's own: the kernel wakes it only for the vehicle's messages, and to confirm what
  /// it sent.
  Result<std::unique_ptr<can::Bus>> connect_appliance();

 private:
  Result<std::unique_ptr<can::Bus>> connect(const can::SocketCanOptions& options);

  CanConfig config_;
  can::MockWire wire_{4096};
};

}  // namespace bevloc::firmware
