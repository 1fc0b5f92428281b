#include "firmware/bus_factory.h"

#include "can/pose_publisher.h"
#include "can/socketcan_bus.h"
#include "can/vehicle_input.h"

namespace bevloc::firmware {

Result<std::unique_ptr<can::Bus>> BusFactory::connect() {
  return connect({.fd = config_.variant == can::FrameFormat::kFd});
}

Result<std::unique_ptr<can::Bus>> BusFactory::connect_appliance() {
  can::SocketCanOptions options;
  options.accepted_ids = can::VehicleInput::accepted_ids(config_.base_ids);
  options.confirmed_ids = can::PosePublisher::sent_ids(config_.base_ids, config_.variant);
  options.fd = config_.variant == can::FrameFormat::kFd;
  return connect(options);
}

Result<std::unique_ptr<can::Bus>> BusFactory::connect(const can::SocketCanOptions& options) {
  if (config_.driver == CanDriver::kMock) return wire_.connect();
  auto bus = can::SocketCanBus::open(config_.interface, options);
  if (!bus) return tl::unexpected(bus.error());
  return std::move(*bus);
}

}  // namespace bevloc::firmware
