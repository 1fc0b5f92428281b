// Applies faults to the readings of the simulated GNSS receiver.
#pragma once

#include <optional>
#include <span>

#include "sim/faults/fault.h"
#include "sim/sensors/gnss.h"
#include "sim/vehicle/drive.h"

namespace bevloc::sim {

/// The reading that the receiver sends under the `active` faults, or nothing in an outage.
/// `elapsed_s` is the time in which faults are measured (drive_clock.h), and `drive` gives the
/// truth that some faults refer to. Faults of other inputs are ignored.
std::optional<GnssReading> with_faults(GnssReading reading, double elapsed_s,
                                       std::span<const Fault> active, const Drive& drive);

}  // namespace bevloc::sim
