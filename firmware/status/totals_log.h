// Logs the appliance's totals at its end.
#pragma once

#include "firmware/status/snapshot.h"

namespace bevloc::firmware {

void log_totals(const Snapshot& snapshot);

}  // namespace bevloc::firmware
