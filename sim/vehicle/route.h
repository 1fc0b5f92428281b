// Draws a random route along the lanes of a map.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/map/hd_map.h"
#include "sim/random.h"

namespace bevloc::sim {

/// Returns indices of lanes, each a successor of the one before. Their total length is at least
/// `length_m`, or as much as the dead ends of the map allow. The route prefers lanes that it has
/// visited least. The map must have lanes.
std::vector<uint32_t> random_lane_route(const HdMap& map, double length_m, Random& random);

}  // namespace bevloc::sim
