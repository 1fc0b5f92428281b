// Reads the section `can.vehicle`: which signals of the vehicle's own DBC file carry odometry and
// GNSS.
#pragma once

#include <filesystem>

#include "can/messages/message.h"
#include "can/vehicle/vehicle_binding.h"
#include "common/strict_yaml.h"

namespace bevloc::firmware {

/// Reads the key `dbc`. Returns an empty text if it is missing, which yaml.finish() reports.
std::string read_dbc_name(YamlMap& yaml);

/// Reads the DBC file and finds all signals in it. yaml.finish() reports mistakes: those of the
/// configuration with the key and the names that were probably meant, and those of the DBC file
/// with its line. After a mistake, the result is not complete. `base` has the identifiers that the
/// DBC file must not use for other messages. `dbc_file` is empty if read_dbc_name() found no name.
can::VehicleBinding read_vehicle_bus(YamlMap& yaml, const can::BaseIds& base,
                                     const std::filesystem::path& dbc_file);

}  // namespace bevloc::firmware
