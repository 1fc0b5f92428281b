// Everything painted along the town's roads.
#pragma once

#include "sim/world/road_network.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// Lane dividers and edge lines (dividers are map elements), stop lines, arrows, bays, tar joints.
void add_road_markings(const RoadNetwork& network, WorldBuilder& builder);

/// The crossings on the junctions' arms and between the junctions.
void add_crossings(const RoadNetwork& network, WorldBuilder& builder);

}  // namespace bevloc::sim
