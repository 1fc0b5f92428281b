// Builds the surfaces and edges of roads and junctions: asphalt, kerbs, sidewalks, islands.
#pragma once

#include "sim/world/road_network.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// Adds surfaces, boundaries and medians of the roads between the junctions.
void add_road_edges(const RoadNetwork& network, WorldBuilder& builder);

/// Adds surfaces and boundaries of the junctions.
void add_junction_edges(const RoadNetwork& network, WorldBuilder& builder);

}  // namespace bevloc::sim
