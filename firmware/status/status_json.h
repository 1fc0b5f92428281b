// The daemon's status as JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "firmware/status/process_use.h"
#include "firmware/status/telemetry.h"

namespace bevloc::firmware {

/// Returns /status.json, whose keys docs/live.md lists. Angles are in degrees, because people read
/// them.
nlohmann::json status_json(const Telemetry& telemetry, const ProcessUse& process, Duration age);

}  // namespace bevloc::firmware
