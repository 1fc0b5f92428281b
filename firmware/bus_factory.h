// Endpoints of the configured CAN bus.
#pragma once

#include <memory>

#include "can/mock_bus.h"
#include "firmware/config.h"

namespace bevloc::firmware {

class BusFactory {
 public:
  explicit BusFactory(const CanConfig& config) : config_(config) {}

  /// One more node on the bus: on the mock wire, or a socket on the interface. Fails where the
  /// interface cannot be opened.
  Result<std::unique_ptr<can::Bus>> connect();

 private:
  CanConfig config_;
  can::MockWire wire_{4096};
};

}  // namespace bevloc::firmware
