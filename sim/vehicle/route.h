// A random route along a map's lanes.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/map/hd_map.h"
#include "sim/random.h"

namespace bevloc::sim {

/// Lanes, each a successor of the one before, at least `length_m` long together, or as long as the
/// map's dead ends allow. Goes where it has been least. The map must have lanes.
std::vector<uint32_t> random_lane_route(const HdMap& map, double length_m, Random& random);

}  // namespace bevloc::sim
