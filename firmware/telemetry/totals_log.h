// Logs the appliance's totals at its end: frames, framesets, trigger and CAN bus.
#pragma once

#include "drivers/trigger/trigger.h"
#include "firmware/runtime/appliance.h"

namespace bevloc::firmware {

/// To be called after all threads have ended. `trigger`: null without one.
void log_totals(const Appliance& appliance, const drivers::Trigger* trigger);

}  // namespace bevloc::firmware
