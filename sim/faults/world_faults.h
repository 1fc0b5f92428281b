// Applies faults to the world that the cameras see. The map that the appliance gets does not
// change.
#pragma once

#include <span>

#include "sim/faults/fault.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The world with its faults. Its map stays. Faults of other inputs are ignored.
World with_faults(World world, std::span<const Fault> faults);

}  // namespace bevloc::sim
