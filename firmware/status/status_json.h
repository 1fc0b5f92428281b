// The daemon's status as JSON, and as one page of text.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "firmware/status/metrics.h"
#include "firmware/status/telemetry.h"

namespace bevloc::firmware {

/// Returns /status.json, whose keys docs/live.md lists. Angles are in degrees, because people read
/// them.
nlohmann::json status_json(const Telemetry& telemetry, const ProcessUse& process, Duration age);

/// Makes the page that `bevloc status` prints from status_json(). A missing key is shown as "-",
/// because the daemon may have another version.
std::string status_page(const nlohmann::json& status);

}  // namespace bevloc::firmware
