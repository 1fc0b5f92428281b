// Makes maps of any length that are identical around one place.
#pragma once

#include <Eigen/Core>

#include "pipeline/map/hd_map.h"

namespace bevloc::bench {

/// Length of road in kilometres: half the length of the road boundaries.
double road_km(const HdMap& map);

/// A map with about `wanted_km` of road and no lanes. If `map` is long enough, the result has its
/// elements nearest to `place`. Otherwise it has copies of `map` side by side, the first one at its
/// original position.
HdMap repeated_town(const HdMap& map, const Eigen::Vector2d& place, double wanted_km);

}  // namespace bevloc::bench
