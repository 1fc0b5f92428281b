// Places houses, fences, hedges, trees, lamps and signs beside the roads.
#pragma once

#include <vector>

#include "sim/world/path.h"
#include "sim/world/town_style.h"
#include "sim/world/world_builder.h"

namespace bevloc::sim {

/// A line along a road's edge. The land on its right is free from `clear_m` on.
struct Roadside {
  Polyline edge;
  double clear_m = 2.0;  ///< width of verge and sidewalk
};

/// Adds scenery along the roadsides and scattered trees. It keeps off paved ground and off the
/// lines in `keep_off`.
void add_scenery(const std::vector<Roadside>& roadsides, const std::vector<Polyline>& keep_off,
                 WorldBuilder& builder);

}  // namespace bevloc::sim
