// Runs the appliance: with threads on the machine's clock, or in lockstep on a virtual clock.
#pragma once

#include <functional>

#include "drivers/clock/clock.h"
#include "firmware/runtime/appliance.h"
#include "firmware/threads/realtime.h"

namespace bevloc::firmware {

/// The parts that run beside the appliance in a simulated drive: the vehicle and the judge.
struct Companion {
  std::function<Time()> next_due;                ///< the time of the next act()
  std::function<void(Time now)> act;             ///< the vehicle: sends what is due
  std::function<void(Duration timeout)> listen;  ///< the judge: waits for CAN frames
};

/// Exit code of a process that ended while one of its threads hung.
inline constexpr int kHungExitCode = 3;

/// A function that is called about ten times per second in the calling thread. It returns false to
/// end the run.
using Supervise = std::function<bool(Time now)>;

/// Starts one thread for each camera, one each for vision, CAN in, CAN out and, if there is one,
/// the GNSS stage, and two for the companion. The calling thread supervises. `realtime` applies to
/// the appliance's threads only. `companion` is null if there is none. Returns after `supervise`
/// has returned false, all threads have ended and the sign-off is sent. If a thread hangs and does
/// not end within 4 s, the process exits with kHungExitCode after the sign-off. If a thread cannot
/// be started, or `supervise` throws, the exception is passed on after all threads have ended,
/// without the sign-off.
void run_threads(Appliance& appliance, Realtime& realtime, const Companion* companion,
                 const Supervise& supervise);

/// Runs all stages in the calling thread, one bus cycle after the other. Computing takes no virtual
/// time. The same inputs give the same CAN frames, bit for bit. `companion` is null if there is
/// none.
void run_lockstep(Appliance& appliance, drivers::VirtualClock& clock, const Companion* companion,
                  const Supervise& supervise);

}  // namespace bevloc::firmware
