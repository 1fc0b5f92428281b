// Checks whether a vehicle can be localized in a map at all.
#pragma once

#include <string>

#include "common/result.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Points of a map must be this close to its origin along both axes: further away, the CAN bus
/// cannot express the position (LOC_PosLocal), and the tangent plane fits the earth badly.
inline constexpr double kFarthestFromOriginM = 83'000.0;

/// Whether a point of a map is finite and near enough to the origin.
inline bool is_near_origin(const Eigen::Vector2d& point) {
  return point.allFinite() && point.cwiseAbs().maxCoeff() <= kFarthestFromOriginM;
}

/// A map without a place on earth is moved to zero if its middle is farther than this from zero.
inline constexpr double kFarFromZeroM = 20'000.0;

/// The longest polyline. A longer one is a mistake in its coordinates.
inline constexpr double kLongestPolylineM = 50'000.0;

/// The shortest centre line of a lane. A simulated route along shorter lanes might never end.
inline constexpr double kShortestLaneM = 0.01;

/// Says that a map around `middle` is too far from (0, 0) for an origin given by the user.
tl::unexpected<Error> far_from_origin(const std::string& file, const Eigen::Vector2d& middle);

/// Fails, with `file` in the message, if no element of the map has a line, or if an element or lane
/// exceeds the limits above or is not finite.
Status check_map(const HdMap& map, const std::string& file);

}  // namespace bevloc
