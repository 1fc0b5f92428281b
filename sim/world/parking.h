// Places parked vehicles along the roads of a town.
#pragma once

#include "sim/world/road_network.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// Parks vehicles in the bays of a road, or half on the kerb on some roads without bays.
void add_parked_vehicles(const RoadNetwork& network, WorldBuilder& builder);

}  // namespace bevloc::sim
