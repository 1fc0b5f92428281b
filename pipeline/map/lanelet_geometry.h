// Geometry of lanelets: aligns their bounds; computes centerlines, crossings and successors.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/plane.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Joins pieces in any order and direction whose ends are at most 0.2 m apart. Returns nothing if
/// they do not form one line. There must be at least one piece, each with two points or more.
std::optional<Polyline> joined(std::vector<Polyline> pieces);

/// Reverses bounds where needed, so that both run in driving direction with `left` on the left. As
/// in Lanelet2, a file may store each bound in either direction.
void align_bounds(Polyline& left, Polyline& right);

/// The line midway between two aligned bounds, with points at most 2 m apart.
Polyline centerline_between(const Polyline& left, const Polyline& right);

/// The median of the x and the median of the y coordinates. A few wrong points hardly change it.
/// `points` must not be empty.
Eigen::Vector2d median_point(const std::vector<Eigen::Vector2d>& points);

/// The length of an element in metres. A crossing counts with its closing edge.
double length_of(const MapElement& element);

/// The area of a ring without a repeated corner.
double area_of_ring_m2(const Polyline& ring);

/// The smallest area of a crossing. A crossing whose two bounds are the same way has no area.
inline constexpr double kLeastCrossing_m2 = 0.5;

/// The indices of the points of a line, in its order, without those within `tolerance_m` of the
/// line through their neighbours.
std::vector<size_t> kept_points(const Polyline& line, double tolerance_m);

/// The indices of the corners of a ring without a repeated corner, in its order. Points within 0.3
/// m of a straight side are left out, so that each long side of a crossing is a single edge.
std::vector<size_t> corners_of_ring(const Polyline& ring);

/// The ring around the area between two bounds, which may run in either direction. It has corners
/// only.
Polyline ring_between(const Polyline& left, const Polyline& right);

/// The lane in the other direction.
Lane reversed(const Lane& lane);

/// Fills the successors. Lane b follows lane a if both bounds of b start where those of a end, to
/// within 0.1 m.
void link_successors(std::vector<Lane>& lanes);

}  // namespace bevloc
