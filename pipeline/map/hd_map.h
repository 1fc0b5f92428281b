// The vectorised HD map, independent of the file it came from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace bevloc {

/// The paper's classes, in the order of the raster's channels.
enum class ElementClass : uint8_t { kLaneDivider = 0, kPedestrianCrossing = 1, kRoadBoundary = 2 };

/// What an element looks like. The localizer never reads it (a raster shows the class alone); the
/// simulator paints and builds by it, and the tools print it.
enum class Appearance : uint8_t {
  kUnknown = 0,
  // lane dividers
  kSolid,
  kDashed,
  kDoubleSolid,
  // crossings
  kZebra,
  kLadder,
  // road boundaries
  kKerb,
  kRoadEdge,
  kBarrier,
  kGuardRail,
  kWall,
  kFence,
  kHedge,
};

/// One line or area on the ground, in the map frame (metres east and north of the origin).
struct MapElement {
  ElementClass element_class = ElementClass::kLaneDivider;
  Appearance appearance = Appearance::kUnknown;
  /// A divider's or boundary's polyline, or a crossing's ring (not repeating its first corner).
  std::vector<Eigen::Vector2d> points;
};

/// A lane that vehicles drive along; the localizer does not use it, routes do.
struct Lane {
  std::vector<Eigen::Vector2d> left;   ///< left bound in driving direction
  std::vector<Eigen::Vector2d> right;  ///< right bound in driving direction
  std::vector<Eigen::Vector2d> centerline;
  std::vector<uint32_t> successors;  ///< indices into HdMap::lanes
  double speed_limit_mps = 13.9;
};

/// WGS84 position of the map frame's origin; the frame is the local east-north tangent plane there.
struct GeoOrigin {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

struct HdMap {
  std::string name;
  GeoOrigin origin;
  std::vector<MapElement> elements;
  std::vector<Lane> lanes;
};

}  // namespace bevloc
