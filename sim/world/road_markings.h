// Paints the roads of a town.
#pragma once

#include "sim/world/road_network.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// Adds lane dividers and edge lines (as paint and map elements), stop lines, arrows, parking bays
/// and tar joints.
void add_road_markings(const RoadNetwork& network, WorldBuilder& builder);

/// Adds the pedestrian crossings on the arms of junctions and between junctions.
void add_crossings(const RoadNetwork& network, WorldBuilder& builder);

}  // namespace bevloc::sim
