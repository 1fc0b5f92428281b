// The place on earth of a point of the map's tangent plane.
#pragma once

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// The place on the ellipsoid whose height 0 projects on `point` (metres east and north): the
/// inverse of LocalCartesian::Forward with height 0. The height of the plane above the ellipsoid
/// grows with the distance from its origin (2 m at 5 km, 240 m at 55 km). LocalCartesian::Reverse
/// of height 0 above the plane is therefore up to 2 m off at 55 km.
GeoOrigin place_of(const GeographicLib::LocalCartesian& plane, const Eigen::Vector2d& point);

/// The point of the plane (metres east and north) over a place at height 0. Beyond the horizon, the
/// first coordinate is the distance through the earth, so that no place there looks near.
Eigen::Vector2d point_of(const GeographicLib::LocalCartesian& plane, const GeoOrigin& place);

}  // namespace bevloc
