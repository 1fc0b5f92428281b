// The metrics in Prometheus' text format.
#pragma once

#include <string>

#include "firmware/status/telemetry.h"

namespace bevloc::firmware {

/// Memory and CPU time of this process, from the kernel.
struct ProcessUse {
  double resident_bytes = 0.0;
  double cpu_s = 0.0;
};

/// Zero where the kernel does not say.
ProcessUse use_of_this_process();

/// The text of /metrics; `age` as in check_health(). docs/live.md lists the metrics.
std::string metrics_text(const Telemetry& telemetry, const ProcessUse& process, Duration age);

}  // namespace bevloc::firmware
