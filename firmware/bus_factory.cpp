#include "firmware/bus_factory.h"

#include "can/socketcan_bus.h"

namespace bevloc::firmware {

Result<std::unique_ptr<can::Bus>> BusFactory::connect() {
  if (config_.driver == CanDriver::kMock) return wire_.connect();
  auto bus = can::SocketCanBus::open(config_.interface);
  if (!bus) return tl::unexpected(bus.error());
  return std::move(*bus);
}

}  // namespace bevloc::firmware
