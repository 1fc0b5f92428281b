// Changes to a world and to its map that make the localizer's work harder.
#pragma once

#include <cstdint>
#include <vector>

#include "common/se2.h"
#include "sim/samples/nuisances.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// Multiplies the wear of all paint; some is left of every line.
void wear_paint(double factor, World& world);

/// Puts `count` vehicles on the lanes around each of the poses, as far as there is room.
void add_standing_vehicles(const std::vector<Se2>& poses, int count, uint64_t seed, World& world);

/// What an older, hastier survey would have made of the map. Lanes stay as they are.
HdMap with_errors(const HdMap& map, const MapErrors& errors, uint64_t seed);

}  // namespace bevloc::sim
