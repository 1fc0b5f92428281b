// Generates the lanes of a town: along its roads, across junctions and around roundabouts.
#pragma once

#include "sim/world/road_network.h"

namespace bevloc::sim {

/// Appends the network's lanes to the map. Each lane has a successor that begins where it ends.
void add_lanes(const RoadNetwork& network, HdMap& map);

}  // namespace bevloc::sim
