// Two ways to run the appliance: threads on the machine's clock, or lockstep on a virtual one.
#pragma once

#include <functional>

#include "drivers/clock/clock.h"
#include "firmware/appliance.h"
#include "firmware/realtime.h"

namespace bevloc::firmware {

/// What else takes part while the appliance runs: the simulated vehicle and its judge in a demo,
/// nothing on a vehicle.
struct Companion {
  std::function<Time()> next_due;        ///< when act() has something to do next
  std::function<void(Time now)> act;     ///< the rest of the vehicle
  std::function<void(Duration)> listen;  ///< the judge; waits for frames at most this long
};

/// Called about ten times a second, in the calling thread; false ends the run.
using Supervise = std::function<bool(Time now)>;

/// One thread per camera, one for vision, one for CAN in, one for CAN out (and two for the
/// companion, if there is one); the calling thread supervises. `realtime` holds for the appliance's
/// threads, not for supervision and the companion. Returns when `supervise` says so, with every
/// thread joined and the end told on the bus.
void run_threads(Appliance& appliance, Realtime& realtime, const Companion* companion,
                 const Supervise& supervise);

/// One thread does everything in the order of time, a bus cycle at a time; computing takes no time.
/// The same inputs give the same frames on the bus, bit for bit.
void run_lockstep(Appliance& appliance, drivers::VirtualClock& clock, const Companion* companion,
                  const Supervise& supervise);

}  // namespace bevloc::firmware
