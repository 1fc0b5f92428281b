// Makes the simulated world of a configuration, and the drive through it.
#pragma once

#include <memory>

#include "common/result.h"
#include "evaluation/drive/drive_config.h"
#include "sim/vehicle/drive.h"
#include "sim/world/world.h"

namespace bevloc::evaluation {

/// A procedural town, or a world dressed on the configuration's map file with the drive's seed (the
/// default seed if the configuration has no section `simulation`). Fails if the map file cannot be
/// read or has no lanes.
Result<sim::World> make_configured_world(const DriveConfig& config);

/// The drive through this world, with the configured seed, stops and pace. It lasts for the
/// configured duration and `added_s`.
std::shared_ptr<const sim::Drive> make_configured_drive(const sim::World& world,
                                                        const SimulationConfig& simulation,
                                                        double added_s = 0.0);

}  // namespace bevloc::evaluation
