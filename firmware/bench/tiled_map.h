// Maps of any length that look the same around one place.
#pragma once

#include <Eigen/Core>

#include "pipeline/map/hd_map.h"

namespace bevloc::bench {

/// Kilometres of road: half the length of the road boundaries.
double road_km(const HdMap& map);

/// A map with about `wanted_km` of road: the elements of `map` that are nearest to `place`, or,
/// where they are not enough, copies of the map side by side, the first where it is. Without lanes.
HdMap tiled_map(const HdMap& map, const Eigen::Vector2d& place, double wanted_km);

}  // namespace bevloc::bench
