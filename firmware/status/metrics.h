// The metrics in Prometheus' text format.
#pragma once

#include <string>

#include "firmware/status/process_use.h"
#include "firmware/status/telemetry.h"

namespace bevloc::firmware {

/// Returns the text of /metrics. `age` means the same as in check_health(). docs/live.md lists the
/// metrics.
std::string metrics_text(const Telemetry& telemetry, const ProcessUse& process, Duration age);

}  // namespace bevloc::firmware
