#include "firmware/bus_factory.h"

#include "can/socketcan_bus.h"
#include "can/vehicle_input.h"

namespace bevloc::firmware {

Result<std::unique_ptr<can::Bus>> BusFactory::connect() {
  return connect(std::vector<uint32_t>());
}

Result<std::unique_ptr<can::Bus>> BusFactory::connect_appliance() {
  return connect(can::VehicleInput::accepted_ids(config_.base_ids));
}

Result<std::unique_ptr<can::Bus>> BusFactory::connect(const std::vector<uint32_t>& accepted_ids) {
  if (config_.driver == CanDriver::kMock) return wire_.connect();
  auto bus = can::SocketCanBus::open(config_.interface, accepted_ids);
  if (!bus) return tl::unexpected(bus.error());
  return std::move(*bus);
}

}  // namespace bevloc::firmware
