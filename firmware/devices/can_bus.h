// Opens the CAN interface of the configuration.
#pragma once

#include <memory>

#include "can/bus/bus.h"
#include "can/bus/socketcan_link.h"
#include "can/messages/geo_reference.h"
#include "can/messages/vehicle_decoder.h"
#include "firmware/config/config.h"

namespace bevloc::firmware {

/// The options of the appliance's socket. The kernel's filter passes only the vehicle's messages,
/// the confirmations of sent frames, and frames of other nodes with an identifier of the localizer,
/// of either variant, so nothing else wakes the CAN-in thread.
can::SocketCanOptions appliance_options(const CanConfig& config);

/// Makes the decoder of the vehicle's messages: those of `can.vehicle`, or else bevloc's own.
std::unique_ptr<can::VehicleDecoder> make_vehicle_decoder(const CanConfig& config,
                                                          can::GeodeticPosition map_origin);

/// Opens the appliance's socket. Fails if the interface cannot be opened, and with `can.driver:
/// mock`.
Result<std::unique_ptr<can::Bus>> open_can_bus(const CanConfig& config);

}  // namespace bevloc::firmware
