// Blink patterns of the status LED.
#pragma once

#include "common/time.h"
#include "firmware/health/health.h"

namespace bevloc::firmware {

/// Whether the LED is lit at `now`. Patterns repeat; each character is a tenth of a second:
///   INIT        #---------  one flash per second
///   ACQUIRING   #####-----  slow blinking
///   TRACKING    ##########  steady
///   DEGRADED    #########-  steady with one short gap per second
///   LOST        #-#-------  two flashes per second (brief: ACQUIRING follows)
///   FAULT       ##--        fast blinking
bool is_lit(HealthState state, Time now);

}  // namespace bevloc::firmware
