// Geometry of lanelets: their bounds put in order, and what follows from them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/map/hd_map.h"

namespace bevloc {

using Polyline = std::vector<Eigen::Vector2d>;

/// Turns the bounds so that both run in driving direction: left of the lane lies `left`. The file
/// may hold either bound in either direction; the sides decide, as in Lanelet2.
void align_bounds(Polyline& left, Polyline& right);

/// Points half way between two aligned bounds, at most 2 m apart.
Polyline centerline_between(const Polyline& left, const Polyline& right);

/// The outline between two bounds, which may run either way. Points that a straight line misses by
/// less than 0.3 m are left out, so that the long edges of a crossing are single edges.
Polyline ring_between(const Polyline& left, const Polyline& right);

/// Fills the successors: lane b follows lane a where both bounds of b start where those of a end.
void link_successors(std::vector<Lane>& lanes);

}  // namespace bevloc
