// Reads the section `can.vehicle`: which signals of the vehicle's own DBC file carry odometry and
// GNSS.
#pragma once

#include <filesystem>

#include "can/messages/message.h"
#include "can/vehicle/vehicle_binding.h"
#include "common/strict_yaml.h"

namespace bevloc::firmware {

/// Reads the DBC file and finds all signals in it. Mistakes are reported by yaml.finish(), with the
/// key and the names that were probably meant; the result is then not complete. `base` has the
/// identifiers that the DBC file must not use for other messages. Paths are relative to `folder`.
can::VehicleBinding read_vehicle_bus(YamlMap& yaml, const can::BaseIds& base,
                                     const std::filesystem::path& folder);

}  // namespace bevloc::firmware
