#include "firmware/devices/can_bus.h"

#include "can/bus/socketcan_bus.h"
#include "can/messages/message_table.h"
#include "can/messages/vehicle_input.h"
#include "can/publisher/pose_publisher.h"
#include "can/vehicle/dbc_vehicle_input.h"

namespace bevloc::firmware {

can::SocketCanOptions appliance_options(const CanConfig& config) {
  can::SocketCanOptions options;
  options.accepted_ids =
      config.vehicle ? can::ids_of(*config.vehicle)
                     : can::VehicleInput::accepted_ids(config.base_ids, config.secoc.has_value());
  options.confirmed_ids = can::PosePublisher::sent_ids(
      config.base_ids, config.variant, config.secoc.has_value(), config.sends_clock);
  options.reserved_ids = can::localizer_ids(config.base_ids);
  options.fd =
      config.variant == can::FrameFormat::kFd || (config.vehicle && can::needs_fd(*config.vehicle));
  return options;
}

std::unique_ptr<can::VehicleDecoder> make_vehicle_decoder(const CanConfig& config,
                                                          can::GeodeticPosition map_origin) {
  if (config.vehicle) {
    return std::make_unique<can::DbcVehicleInput>(*config.vehicle, config.base_ids, map_origin,
                                                  config.rear_track_m);
  }
  return std::make_unique<can::VehicleInput>(config.base_ids, map_origin, config.rear_track_m);
}

Result<std::unique_ptr<can::Bus>> open_can_bus(const CanConfig& config) {
  if (config.driver == CanDriver::kMock) {
    return fail("can.driver: found mock, which this bevlocd was built without, wanted socketcan");
  }
  auto bus = can::SocketCanBus::open(config.interface, appliance_options(config));
  if (!bus) return tl::unexpected(bus.error());
  return std::move(*bus);
}

}  // namespace bevloc::firmware
