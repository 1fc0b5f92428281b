// The ground and the edges of the town's roads and junctions: asphalt, kerbs, sidewalks, islands.
#pragma once

#include "sim/world/road_network.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// Surfaces, boundaries and medians of the roads between their junctions.
void add_road_edges(const RoadNetwork& network, WorldBuilder& builder);

/// Surfaces and boundaries of the junctions.
void add_junction_edges(const RoadNetwork& network, WorldBuilder& builder);

}  // namespace bevloc::sim
