// Makes the simulated world of a configuration.
#pragma once

#include "common/result.h"
#include "evaluation/drive/drive_config.h"
#include "sim/world/world.h"

namespace bevloc::evaluation {

/// A procedural town, or a world dressed on the configuration's map file with the drive's seed (the
/// default seed if the configuration has no section `simulation`). Fails if the map file cannot be
/// read or has no lanes.
Result<sim::World> make_configured_world(const DriveConfig& config);

}  // namespace bevloc::evaluation
