// Applies faults to the map that the appliance gets. The world that its cameras see does not
// change.
#pragma once

#include <span>

#include "pipeline/map/hd_map.h"
#include "sim/faults/fault.h"
#include "sim/vehicle/drive.h"

namespace bevloc::sim {

/// The map with its faults. The origin stays. `drive` tells where the vehicle will be. Faults of
/// other inputs are ignored.
HdMap with_faults(HdMap map, std::span<const Fault> faults, const Drive& drive);

}  // namespace bevloc::sim
