// The map as a survey gives it that records every dash, as survey-grade maps do.
#pragma once

#include "pipeline/map/hd_map.h"
#include "sim/perception/dashed_line.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The dashes of each element of the world's map, where the paint on the road has them. Stations
/// are along the element. Elements that are not dashed, and dashed ones that are in the map but not
/// on the road, are one whole.
MapDashes painted_dashes(const World& world);

/// The map with each element replaced by its dashes, one element per dash: element by element,
/// each one's dashes in order. Elements that are one whole stay as they are; all does if `dashes`
/// is empty.
HdMap surveyed_map(const HdMap& map, const MapDashes& dashes);

}  // namespace bevloc::sim
