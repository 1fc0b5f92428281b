// The simulated world that a configuration names.
#pragma once

#include "common/result.h"
#include "firmware/config.h"
#include "sim/world/world.h"

namespace bevloc::firmware {

/// A made-up town, or the configuration's map dressed by `seed`. Fails when the map file cannot be
/// read or has no lanes to drive on.
Result<sim::World> make_configured_world(const MapConfig& config, uint64_t seed);

}  // namespace bevloc::firmware
