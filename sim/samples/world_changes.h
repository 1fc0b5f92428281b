// Changes a world or its map so that localization gets harder.
#pragma once

#include <cstdint>
#include <vector>

#include "common/se2.h"
#include "sim/samples/nuisances.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Multiplies the wear of all paint, up to a limit that leaves some of every line.
void wear_paint(double factor, World& world);

/// Places up to `count` standing vehicles on the lanes around each pose, as far as there is room.
void add_standing_vehicles(const std::vector<Se2>& poses, int count, uint64_t seed, World& world);

/// Lets grass or dirt grow over a share of the road's edges, 0.1 to 1.5 m wide.
void add_verges(double share, uint64_t seed, World& world);

/// Returns the map with errors as from an old or careless survey. Lanes do not change.
HdMap with_errors(const HdMap& map, const MapErrors& errors, uint64_t seed);

}  // namespace bevloc::sim
