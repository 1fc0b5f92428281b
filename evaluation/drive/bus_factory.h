// Connects the nodes of a simulated vehicle to the CAN bus of the configuration.
#pragma once

#include <memory>

#include "can/bus/mock_bus.h"
#include "can/bus/socketcan_link.h"
#include "firmware/config/config.h"

namespace bevloc::evaluation {

/// One thread.
class BusFactory {
 public:
  explicit BusFactory(const firmware::CanConfig& config) : config_(config) {}

  /// Adds a node that receives all frames, on the mock wire or on a socket. Fails if the interface
  /// cannot be opened.
  Result<std::unique_ptr<can::Bus>> connect();

  /// Adds the appliance's node, with its receive filter (firmware::appliance_options()).
  Result<std::unique_ptr<can::Bus>> connect_appliance();

 private:
  Result<std::unique_ptr<can::Bus>> connect(const can::SocketCanOptions& options);

  firmware::CanConfig config_;
  can::MockWire wire_{4096};
};

}  // namespace bevloc::evaluation
