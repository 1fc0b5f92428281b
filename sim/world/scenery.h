// What stands beside the road: houses, fences, hedges, trees, lamps, signs.
#pragma once

#include <vector>

#include "sim/world/path.h"
#include "sim/world/town_style.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// A line along a road's edge; the land on its right is free from `clear_m` on.
struct Roadside {
  Polyline edge;
  double clear_m = 2.0;  ///< width of verge and sidewalk
};

/// Keeps off everything that is paved, and off the given lines.
void add_scenery(const std::vector<Roadside>& roadsides, const std::vector<Polyline>& keep_off,
                 WorldBuilder& builder);

}  // namespace bevloc::sim
