// What the status LED shows.
#pragma once

#include "common/time.h"
#include "firmware/health.h"

namespace bevloc::firmware {

/// Whether the LED is lit at `now`. Tenths of a second, over and over:
///   INIT        #---------  a flash every second
///   ACQUIRING   #####-----  slow blinking
///   TRACKING    ##########  steady
///   DEGRADED    #########-  steady, with a wink every second
///   LOST        #-#-------  a double flash every second (in passing: it leads to ACQUIRING)
///   FAULT       ##--        fast blinking
bool is_lit(State state, Time now);

}  // namespace bevloc::firmware
