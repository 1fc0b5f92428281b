// What identifies a run: the checksums of the program and of the files that it uses.
#pragma once

#include <cstdint>
#include <string_view>

#include "can/messages/identity_message.h"
#include "firmware/config/config.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::firmware {

/// Computes the checksums. Those of configuration and rig are of the files as load_config() read
/// them; the model is read now. A file that cannot be read, or that the configuration does not
/// name, has the checksum 0.
can::Identity identity_of(const Config& config, const HdMap& map);

/// Returns LOC_Status.MapId: map_checksum(), folded to 16 bits.
uint16_t map_id_of(const HdMap& map);

/// Logs the identity with the names of model and map.
void log_identity(const can::Identity& identity, const HdMap& map, std::string_view model_name);

}  // namespace bevloc::firmware
