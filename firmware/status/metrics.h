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

/// Asks the kernel. A value that it does not tell is zero.
ProcessUse use_of_this_process();

/// Returns the text of /metrics. `age` means the same as in check_health(). docs/live.md lists the
/// metrics.
std::string metrics_text(const Telemetry& telemetry, const ProcessUse& process, Duration age);

}  // namespace bevloc::firmware
