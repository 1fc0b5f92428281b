// Finds the paved ground of a map that has only lanes and lines.
#pragma once

#include <vector>

#include "pipeline/map/hd_map.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The lanes, and what lies between them and the nearest boundary or lane beside them: parking
/// strips, cycle lanes, mouths and the inside of junctions. Asphalt ends at the boundary; where
/// there is none within 6 m, it ends 0.3 m beside the lane. The rings overlap.
std::vector<Ring> paved_rings(const HdMap& map);

}  // namespace bevloc::sim
