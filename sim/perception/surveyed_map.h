// Builds a map with one element per dash, as survey-grade maps have.
#pragma once

#include "pipeline/map/hd_map.h"
#include "sim/perception/dashed_line.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The dashes of each element of the world's map, from the paint on the road. Stations are along
/// the element. Elements that are not dashed, or that are not painted on the road, are continuous.
MapDashes painted_dashes(const World& world);

/// Replaces each element of the map by one element per dash, in order. Continuous elements stay as
/// they are. If `dashes` is empty, the map is returned unchanged.
HdMap surveyed_map(const HdMap& map, const MapDashes& dashes);

}  // namespace bevloc::sim
