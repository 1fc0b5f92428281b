// Parked vehicles along the town's roads.
#pragma once

#include "sim/world/road_network.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// In bays where the road has them, here and there half on the kerb where it has none.
void add_parked_vehicles(const RoadNetwork& network, WorldBuilder& builder);

}  // namespace bevloc::sim
