#include "evaluation/drive/bus_factory.h"

#include "can/bus/socketcan_bus.h"
#include "firmware/devices/can_bus.h"

namespace bevloc::evaluation {

Result<std::unique_ptr<can::Bus>> BusFactory::connect() {
  return connect({.fd = config_.variant == can::FrameFormat::kFd});
}

Result<std::unique_ptr<can::Bus>> BusFactory::connect_appliance() {
  return connect(firmware::appliance_options(config_));
}

Result<std::unique_ptr<can::Bus>> BusFactory::connect(const can::SocketCanOptions& options) {
  if (config_.driver == firmware::CanDriver::kMock) return wire_.connect();
  auto bus = can::SocketCanBus::open(config_.interface, options);
  if (!bus) return tl::unexpected(bus.error());
  return std::move(*bus);
}

}  // namespace bevloc::evaluation
