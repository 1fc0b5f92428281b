// Applies faults to the readings of the simulated GNSS receiver.
#pragma once

#include <optional>
#include <span>

#include "sim/faults/fault.h"
#include "sim/sensors/gnss.h"
#include "sim/vehicle/drive.h"

namespace bevloc::sim {

/// The reading `index` under the `active` faults, or nothing in an outage. The times of the faults
/// are those of the drive, and `drive` gives the truth that some faults refer to. Faults of other
/// inputs are ignored.
std::optional<GnssReading> reading_with_faults(const GnssSimulator& gnss, size_t index,
                                               std::span<const Fault> active, const Drive& drive);

}  // namespace bevloc::sim
