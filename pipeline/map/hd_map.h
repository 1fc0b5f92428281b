// The HD map in memory, independent of the file format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace bevloc {

/// The paper's classes, in the order of the raster channels.
enum class ElementClass : uint8_t { kLaneDivider = 0, kPedestrianCrossing = 1, kRoadBoundary = 2 };
/// The number of classes.
inline constexpr size_t kElementClasses = static_cast<size_t>(ElementClass::kRoadBoundary) + 1;

/// How an element looks. The localizer does not use it, because a raster shows only the class. The
/// simulator paints and builds the element accordingly.
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
/// The number of appearances.
inline constexpr size_t kAppearances = static_cast<size_t>(Appearance::kHedge) + 1;

/// Whether the points of such an element are the corners of a ring.
constexpr bool is_ring(ElementClass element_class) {
  return element_class == ElementClass::kPedestrianCrossing;
}

/// One line or polygon on the ground, in the map frame (metres east and north of the origin).
struct MapElement {
  ElementClass element_class = ElementClass::kLaneDivider;
  Appearance appearance = Appearance::kUnknown;
  /// Polyline of a divider or boundary; ring of a crossing, without a repeated first corner.
  std::vector<Eigen::Vector2d> points;
};

/// The number of segments. Segment i begins at point i; the last one of a ring closes it.
inline size_t segment_count(const MapElement& element) {
  const size_t count = element.points.size();
  if (is_ring(element.element_class) && count > 2) return count;
  return count > 0 ? count - 1 : 0;
}

/// The end of the segment that begins at point `first`.
inline const Eigen::Vector2d& segment_end(const MapElement& element, size_t first) {
  return element.points[(first + 1) % element.points.size()];
}

/// A lane for vehicles. The simulator plans routes along lanes; the localizer does not use them.
struct Lane {
  std::vector<Eigen::Vector2d> left;   ///< left bound in driving direction
  std::vector<Eigen::Vector2d> right;  ///< right bound in driving direction
  std::vector<Eigen::Vector2d> centerline;
  std::vector<uint32_t> successors;  ///< indices into HdMap::lanes
  double speed_limit_mps = 13.9;
};

/// WGS84 position of the origin of the map frame, the east-north tangent plane at that position.
struct GeoOrigin {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// (0, 0) stands for a map that does not say where on earth it is.
inline bool is_known(const GeoOrigin& origin) {
  return origin.latitude_deg != 0.0 || origin.longitude_deg != 0.0;
}

struct HdMap {
  std::string name;
  GeoOrigin origin;
  std::vector<MapElement> elements;
  std::vector<Lane> lanes;
  /// What the reader left out of the file and why, one sentence each, with file and line. Compact
  /// maps have none.
  std::vector<std::string> left_out{};
};

}  // namespace bevloc
